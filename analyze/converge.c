/* k against the spacing of the lattice, extrapolated to spacing 0 if several spacings allow it. */
#include <math.h>
#include <string.h>

#include "analyze/analysis.h"
#include "analyze/chart.h"
#include "analyze/uncertainty.h"
#include "analyze/compatible_runs.h"
#include "analyze/averaging.h"
#include "common/convergence.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/units.h"

struct level {
  const struct run *run;
  size_t group;
  double spacing;      /* m */
  double permeability; /* intrinsic, m^2 */
  bool of_finest;      /* k of the finest lattice of a run that solved several lattices */
  double error;        /* relative, of averaging or residual; NAN: unknown */
};

/* Levels of the same method, wall and direction, finest first, at [first, first + count). */
struct series {
  size_t first, count;
  double formal_order;
  struct convergence result;
  /* Of the finest run, with the convergence index as its resolution. */
  struct uncertainty uncertainty;
  /* Run whose own lattices give k with a smaller error; NULL if none. */
  const struct run *better;
  double better_error; /* relative, of `better`, or of the extrapolation */
};

static enum status measure(const struct run *run, struct level *level) {
  enum status status = STATUS_OK;
  struct average average;
  if (!run_has_permeability(run))
    TRY_FAIL(STATUS_INPUT,
             "%s: the run has no driving force along its flow, so it has no permeability",
             run->path);
  TRY(average_darcy(run, &average));
  if (average.mean == 0)
    TRY_FAIL(STATUS_INPUT,
             "%s: no pore leads through along the force: k is 0, and says nothing of the "
             "resolution; leave it out",
             run->path);
  level->run = run;
  level->spacing = cbrt(run->spacing[0] * run->spacing[1] * run->spacing[2]);
  if (run->dimensions == 2) level->spacing = sqrt(run->spacing[0] * run->spacing[2]);
  level->permeability = average.mean * run->viscosity / (run->density * run_driving(run));
  /* A k extrapolated over several lattices does not belong to one spacing: k of the finest lattice
   * is used. */
  level->of_finest = run->levels.count > 0 && run->k_finest > 0.0;
  if (level->of_finest) {
    level->permeability = run->k_finest * run->viscosity / (run->density * GRAVITY_STANDARD);
    level->spacing = run->levels.spacing[run->levels.count - 1];
  }
  level->error = average.error95 / fabs(average.mean);
  if (isnan(average.drift))
    log_warning("%s: one row of history does not show whether the Darcy velocity has settled; its "
                "k is not final",
                run->path);
  else if (!average.without_drift)
    log_warning("%s: the Darcy velocity still drifts by %.1f %%; its k is not final", run->path,
                100.0 * fabs(average.drift / average.mean));
cleanup:
  return status;
}

static bool same_series(const struct run *a, const struct run *b) {
  double aligned = 0.0;
  for (int d = 0; d < 3; d++) aligned += a->direction[d] * b->direction[d];
  return strcmp(a->method, b->method) == 0 && strcmp(a->wall, b->wall) == 0 && aligned > 0.999;
}

static enum status check_body(const struct run *a, const struct run *b) {
  int d;
  if (compatible_runs_same_body(a, b, &d)) return STATUS_OK;
  return FAIL(
      STATUS_INPUT,
      "%s and %s do not show the same body (%g and %g m along %c): give runs of one scan or "
      "scene at different spacings",
      a->path, b->path, (double)a->size[d] * a->spacing[d], (double)b->size[d] * b->spacing[d],
      "xyz"[d]);
}

/* Insertion sort by group, then spacing. */
static void sort_levels(struct level *levels, size_t n) {
  for (size_t i = 1; i < n; i++) {
    struct level moved = levels[i];
    size_t j = i;
    for (; j > 0 && (levels[j - 1].group > moved.group ||
                     (levels[j - 1].group == moved.group && levels[j - 1].spacing > moved.spacing));
         j--)
      levels[j] = levels[j - 1];
    levels[j] = moved;
  }
}

static enum status make_series(const struct run *runs, size_t n, struct level *levels,
                               struct series *series, size_t *count) {
  enum status status = STATUS_OK;
  size_t longest = 0;
  *count = 0;
  for (size_t i = 0; i < n; i++) {
    size_t first = 0;
    TRY(measure(&runs[i], &levels[i]));
    TRY(check_body(&runs[0], &runs[i]));
    while (first < i && !same_series(&runs[first], &runs[i])) first++;
    levels[i].group = first < i ? levels[first].group : (*count)++;
  }
  sort_levels(levels, n);
  for (size_t i = 0; i < n; i++) {
    struct series *s = &series[levels[i].group];
    if (s->count++ == 0)
      s->first = i;
    else if (levels[i].spacing < 1.0001 * levels[i - 1].spacing)
      TRY_FAIL(STATUS_INPUT,
               "%s and %s have the same spacing, method and wall: give one run for "
               "each spacing",
               levels[i - 1].run->path, levels[i].run->path);
    if (s->count > longest) longest = s->count;
  }
  if (longest < 2)
    TRY_FAIL(STATUS_INPUT,
             "%s: converge needs two or more runs of the same method and wall at different "
             "spacings; make coarser and finer models of the scan with ct2model build --size",
             runs[0].path);
cleanup:
  return status;
}

static void level_uncertainty(const struct level *level, struct uncertainty *u) {
  uncertainty_read(level->run, u);
  if (isnan(u->averaging)) u->averaging = level->error;
}

/* Finds the run whose own lattices give k with a smaller error than the extrapolation over the
 * runs' spacings. */
static void find_better(const struct level *levels, struct series *s) {
  s->better_error = uncertainty_total(&s->uncertainty);
  for (size_t i = s->first; i < s->first + s->count; i++) {
    const struct run *run = levels[i].run;
    struct uncertainty own;
    if (!levels[i].of_finest) continue;
    level_uncertainty(&levels[i], &own);
    if (isnan(own.resolution) || own.resolution_expected ||
        !(uncertainty_total(&own) < s->better_error))
      continue;
    s->better = run;
    s->better_error = uncertainty_total(&own);
  }
}

static enum status extrapolate(const struct level *levels, struct series *s) {
  enum status status = STATUS_OK;
  double *h = NULL;
  const struct run *run = levels[s->first].run;
  level_uncertainty(&levels[s->first], &s->uncertainty);
  /* Frozen walls widen every gap by a constant number of spacings, which is an error of first
   * order. */
  s->formal_order = strcmp(run->wall, "frozen") == 0 ? 1.0 : 2.0;
  if (s->count < 2) return STATUS_OK;
  TRY(memory_allocate(&h, 2 * s->count, sizeof *h, "runs"));
  for (size_t i = 0; i < s->count; i++) {
    h[i] = levels[s->first + i].spacing;
    h[s->count + i] = levels[s->first + i].permeability;
  }
  converge_extrapolate(h, h + s->count, s->count, s->formal_order, &s->result);
  s->uncertainty.resolution = s->result.index;
  s->uncertainty.resolution_expected = false;
  s->uncertainty.resolution_index = true;
  find_better(levels, s);
  if (s->result.near)
    log_warning(
        "%s, %s walls: the spacings are too near each other to tell the resolution's error; "
        "give runs whose spacings differ by a third and more",
        run->method, run->wall[0] ? run->wall : "no");
  else if (s->count > 2 && !s->result.monotone)
    log_warning("%s, %s walls: k does not converge monotonically; the finest value stands, with "
                "three times the range as its error: add a finer run",
                run->method, run->wall[0] ? run->wall : "no");
  else if (s->result.far)
    log_warning(
        "%s, %s walls: the spacings are too coarse to extrapolate from (k would move by more "
        "than half); the finest value stands, with three times the last change as its error: add "
        "finer runs",
        run->method, run->wall[0] ? run->wall : "no");
  else if (s->count > 2 && !s->result.credible)
    log_warning("%s, %s walls: the observed order %.2f is not credible (formal %g): the coarsest "
                "run is too coarse, or something else differs; the error is widened",
                run->method, run->wall[0] ? run->wall : "no", s->result.order, s->formal_order);
cleanup:
  memory_free(&h);
  return status;
}

/* Hydraulic conductivity over intrinsic permeability, 1/(m s), for the fluid of the run. */
static double conductivity_per_permeability(const struct level *level) {
  return level->run->density * GRAVITY_STANDARD / level->run->viscosity;
}

static void series_json(const struct level *levels, const struct series *s, json_t *object) {
  const struct level *fine = &levels[s->first];
  bool ok = s->count > 1;
  double value = ok ? s->result.value : NAN, k = value * conductivity_per_permeability(fine);
  json_t *rows = json_array();
  json_object_set_new(object, "method", json_text(fine->run->method));
  json_object_set_new(object, "wall", json_text(fine->run->wall));
  json_put_number(object, "k_m_per_s", k);
  json_put_number(object, "k_cm_per_s", 100.0 * k);
  json_put_number(object, "k_relative_error", ok ? uncertainty_total(&s->uncertainty) : NAN);
  json_put_number(object, "intrinsic_permeability_m2", value);
  json_put_number(object, "observed_order", ok ? s->result.order : NAN);
  json_object_set_new(object, "fit",
                      json_pack("{s:o,s:o}", "order", json_number(ok ? s->result.order_used : NAN),
                                "slope_m2_per_m_to_the_order",
                                json_number(ok ? s->result.slope : NAN)));
  json_put_number(object, "formal_order", s->formal_order);
  json_object_set_new(object, "order_credible", json_boolean(s->result.credible));
  json_object_set_new(object, "monotone", json_boolean(s->result.monotone));
  json_object_set_new(object, "extrapolated",
                      json_boolean(ok && s->result.monotone && !s->result.far));
  json_object_set_new(object, "spacings_too_near", json_boolean(s->result.near));
  json_put_number(object, "grid_convergence_index", ok ? s->result.index : NAN);
  json_put_number(object, "safety_factor", ok ? s->result.safety : NAN);
  if (s->better != NULL)
    json_object_set_new(object, "better_run",
                        json_pack("{s:o,s:o,s:o}", "path", json_text(s->better->path), "k_m_per_s",
                                  json_number(s->better->k), "k_relative_error",
                                  json_number(s->better_error)));
  uncertainty_json(&s->uncertainty, object);
  for (size_t i = s->first; i < s->first + s->count; i++) {
    const struct level *level = &levels[i];
    json_array_append_new(
        rows,
        json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o}", "path", json_text(level->run->path), "name",
                  json_text(level->run->name), "spacing_m", json_number(level->spacing),
                  "intrinsic_permeability_m2", json_number(level->permeability), "k_m_per_s",
                  json_number(level->permeability * conductivity_per_permeability(level)),
                  "deviation_from_extrapolated", json_number(level->permeability / value - 1.0),
                  "wall_time_s", json_number(level->run->wall_time)));
  }
  json_object_set_new(object, "runs", rows);
}

static void write_summary(const struct level *levels, const struct series *series, size_t count,
                          FILE *stream) {
  for (size_t g = 0; g < count; g++) {
    const struct series *s = &series[g];
    const struct level *fine = &levels[s->first];
    fprintf(stream, "%s%s%s%s\n  %-26s %12s %12s %14s %11s %10s\n", fine->run->method,
            fine->run->wall[0] ? ", " : "", fine->run->wall, fine->run->wall[0] ? " walls" : "",
            "run", "spacing (m)", "k (cm/s)", "K (m^2)", "deviation", "time (s)");
    bool finest = false;
    for (size_t i = s->first; i < s->first + s->count; i++) finest |= levels[i].of_finest;
    if (finest) fputs("  (of runs with several lattices: the finest alone, k_finest)\n", stream);
    for (size_t i = s->first; i < s->first + s->count; i++) {
      const struct level *level = &levels[i];
      fprintf(stream, "  %-26.60s %12.4g %12.5g %14.5g ", level->run->name, level->spacing,
              100.0 * level->permeability * conductivity_per_permeability(level),
              level->permeability);
      if (s->count > 1)
        fprintf(stream, "%+9.2f %% ", 100.0 * (level->permeability / s->result.value - 1.0));
      else
        fprintf(stream, "%11s ", "-");
      fprintf(stream, "%10.4g\n", level->run->wall_time);
    }
    if (s->count < 2) {
      fputs("  one spacing: nothing to extrapolate from\n\n", stream);
      continue;
    }
    double k = s->result.value * conductivity_per_permeability(fine);
    fputs(s->result.far || !s->result.monotone ? "  not extrapolated, the finest: k = "
                                               : "  extrapolated to spacing 0: k = ",
          stream);
    write_value_with_error(stream, 100.0 * k, 100.0 * k * uncertainty_total(&s->uncertainty), "+-",
                           " cm/s");
    fprintf(stream, "\n    = %.5g m/s = %.5g m^2 = %.5g darcy\n", k, s->result.value,
            s->result.value / DARCY);
    if (s->result.near)
      fputs("  TOO NEAR each other to extrapolate, ", stream);
    else if (s->result.far)
      fputs("  TOO COARSE to extrapolate, ", stream);
    else if (isfinite(s->result.order))
      fprintf(stream, "  observed order %.2f (formal %g, %s), ", s->result.order, s->formal_order,
              s->result.credible ? "credible" : "NOT CREDIBLE");
    else if (s->count > 2)
      fputs("  NOT MONOTONE, no order, ", stream);
    else
      fprintf(stream, "  order %g assumed (two spacings do not show one), ", s->formal_order);
    fprintf(stream, "grid convergence index of the finest %.3g %% (safety factor %g)\n",
            100.0 * s->result.index, s->result.safety);
    uncertainty_write(&s->uncertainty, stream);
    if (s->better != NULL) {
      fprintf(stream, "  %.60s alone tells more, by its own lattices: k = ", s->better->name);
      write_value_with_error(stream, 100.0 * s->better->k, 100.0 * s->better->k * s->better_error,
                             "+-", " cm/s");
      fputc('\n', stream);
    }
    fputc('\n', stream);
  }
}

/* k against spacing with the fit; and, for the files, its deviation from the extrapolated k against
 * wall-clock time. */
static void draw(const struct level *levels, const struct series *series, size_t count,
                 json_t *charts) {
  enum { POINTS = 80 };
  json_t *spacing =
      chart_add(charts, "k against spacing", "Spacing (µm)", "k (cm/s)", CHART_ZERO, CHART_OPEN);
  json_t *time = chart_add(charts, "Error against time", "Wall-clock time (s)",
                           "Deviation from the extrapolated k (%)", CHART_LOG_XY, CHART_OF_FILES);
  for (size_t g = 0; g < count; g++) {
    const struct series *s = &series[g];
    const struct level *own = &levels[s->first];
    const double unit = 100.0 * conductivity_per_permeability(own), k0 = unit * s->result.value;
    const double widest = own[s->count - 1].spacing, error = uncertainty_total(&s->uncertainty);
    char name[200], line[300];
    snprintf(name, sizeof name, "%.80s%s%.80s%s", own->run->method, own->run->wall[0] ? ", " : "",
             own->run->wall, own->run->wall[0] ? " walls" : "");
    json_t *dots = chart_series(spacing, name, CHART_DOTS, (int)g, 0);
    for (size_t i = 0; i < s->count; i++)
      chart_point(dots, 1e6 * own[i].spacing, unit * own[i].permeability);
    if (s->count < 2) continue;
    json_t *cost = chart_series(time, name, CHART_DOTS, (int)g, 0);
    for (size_t i = 0; i < s->count; i++)
      if (own[i].permeability != s->result.value)
        chart_point(cost, own[i].run->wall_time,
                    100.0 * fabs(own[i].permeability / s->result.value - 1.0));
    if (isfinite(s->result.order))
      snprintf(line, sizeof line, "%s, order %.2f", name, s->result.order);
    else
      snprintf(line, sizeof line, "%s, order %g assumed", name, s->formal_order);
    json_t *fit = chart_series(spacing, line, CHART_LINE, (int)g, 0);
    for (int i = 0; i <= POINTS && s->result.monotone && !s->result.far; i++) {
      const double h = widest * i / POINTS;
      chart_point(fit, 1e6 * h, k0 + unit * s->result.slope * pow(h, s->result.order_used));
    }
    json_t *limit = chart_series(spacing, "result, 95 %", CHART_DOTS, (int)g, 0);
    chart_interval(limit, 0.0, k0, k0 * (1.0 - error), k0 * (1.0 + error));
  }
}

static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  enum status status = STATUS_OK;
  const struct run *runs = subject->runs;
  const size_t n = subject->n;
  (void)options;
  struct level *levels = NULL;
  struct series *series = NULL;
  size_t count = 0, good = 0, last = 0;
  TRY(memory_allocate(&levels, n, sizeof *levels, "runs"));
  TRY(memory_allocate(&series, n, sizeof *series, "runs"));
  TRY(make_series(runs, n, levels, series, &count));
  json_t *list = json_array();
  json_object_set_new(product->json, "series", list);
  fputs("method,wall,run,spacing_m,intrinsic_permeability_m2,k_m_per_s,extrapolated_m2,"
        "wall_time_s\n",
        product->csv.stream);
  for (size_t g = 0; g < count; g++) {
    struct series *s = &series[g];
    TRY(extrapolate(levels, s));
    json_t *object = json_object();
    series_json(levels, s, object);
    json_array_append_new(list, object);
    if (s->count > 1) {
      good++;
      last = g;
    }
    for (size_t i = s->first; i < s->first + s->count; i++) {
      const struct level *level = &levels[i];
      csv_text(product->csv.stream, level->run->method);
      fputc(',', product->csv.stream);
      csv_text(product->csv.stream, level->run->wall);
      fputc(',', product->csv.stream);
      csv_text(product->csv.stream, level->run->name);
      fprintf(product->csv.stream, ",%.8g,%.8g,%.8g,%.8g,%.6g\n", level->spacing,
              level->permeability, level->permeability * conductivity_per_permeability(level),
              s->count > 1 ? s->result.value : NAN, level->run->wall_time);
    }
  }
  if (good == 1) series_json(levels, &series[last], product->json);
  write_summary(levels, series, count, product->summary.stream);
  draw(levels, series, count, product->charts);
cleanup:
  memory_free(&levels);
  memory_free(&series);
  return status;
}

static enum status applies(const struct subject *subject, bool *applies) {
  *applies = false;
  for (size_t i = 1; subject->permeable > 0 && i < subject->n; i++)
    *applies |= fabs(subject->runs[i].spacing[0] / subject->runs[0].spacing[0] - 1.0) > 1e-4;
  return STATUS_OK;
}

const struct analysis converge_analysis = {
    .name = "converge",
    .command =
        {"converge", "RUN RUN... [-o DIR]",
         "k at spacing 0 from runs at different spacings: order, grid convergence index, cost",
         "analyze converge sand-30.hdf sand-60.hdf sand-120.hdf -o results", 2, -1},
    .several_models = true,
    .heading = "Accuracy",
    .page_runs = OF_PERMEABLE,
    .caption = "k against spacing, and the extrapolation to spacing 0.",
    .may_fail = true, /* runs of different bodies cannot be extrapolated */
    .applies = applies,
    .analyze = analyze};
