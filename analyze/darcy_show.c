/* Output of Darcy's law as text, JSON and chart; the fits are in darcy.c. */
#include "analyze/darcy.h"

#include <math.h>
#include <string.h>

#include "analyze/analysis.h"
#include "analyze/chart.h"
#include "analyze/uncertainty.h"
#include "analyze/tensor.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/units.h"

/* Data of one run. */
struct point {
  struct average average;
  size_t group;
  double gradient, k;
};

struct darcy_table {
  const struct run *runs;
  size_t n, groups;
  struct point *points;
  struct darcy_fit *fits;   /* [groups]; count 0 if all runs of the group drift */
  const struct run **first; /* [groups] */
  struct tensor *tensors;   /* [groups], of the first run of the group that has one */
  bool *has_tensor;
};

static enum status collect(struct darcy_table *table) {
  enum status status = STATUS_OK;
  size_t *group = NULL;
  TRY(memory_allocate(&table->points, table->n, sizeof *table->points, "runs"));
  TRY(memory_allocate(&group, table->n, sizeof *group, "runs"));
  table->groups = runs_group(table->runs, table->n, group);
  TRY(memory_allocate(&table->fits, table->groups, sizeof *table->fits, "runs"));
  TRY(memory_allocate(&table->first, table->groups, sizeof *table->first, "runs"));
  for (size_t i = 0; i < table->n; i++) {
    const struct run *run = &table->runs[i];
    struct point *point = &table->points[i];
    if (!(run->hydraulic_gradient > 0.0))
      TRY_FAIL(STATUS_INPUT,
               "%s: the run has no driving force, so there is no hydraulic gradient; set "
               "force.body_acceleration in its scene, or leave it out",
               run->path);
    if (!run_has_permeability(run))
      TRY_FAIL(STATUS_INPUT,
               "%s: the run has no permeability: neither does a force drive water round, nor two "
               "heads along a column; take the flux of a plane (analyze history), or leave it out",
               run->path);
    TRY(average_darcy(run, &point->average));
    point->group = group[i];
    point->gradient = run->hydraulic_gradient;
    point->k = point->average.mean / point->gradient;
    if (table->first[group[i]] == NULL) table->first[group[i]] = run;
    if (isnan(point->average.drift))
      log_warning("%s: one row of history does not show whether the Darcy velocity has settled, so "
                  "the run is left out of the fit; write more of them (output.history_interval)",
                  run->path);
    else if (!point->average.without_drift)
      log_warning("%s: the Darcy velocity still drifts by %.1f %% over the averaged "
                  "rows, so the run is left out of the fit; run it longer",
                  run->path, 100.0 * fabs(point->average.drift / point->average.mean));
  }
cleanup:
  memory_free(&group);
  return status;
}

/* Warns if k falls with the velocity without a Forchheimer term. With weak inertia k falls with the
 * square of the velocity (Mei, Auriault 1991, J. Fluid Mech. 222, 647), which Forchheimer's law
 * does not fit; k of the line is then not the limit at low gradients. */
static void warn_of_inertia(const double *gradient, const double *velocity, const double *error,
                            size_t n, const struct darcy_fit *fit, const char *run) {
  char text[32];
  size_t low = 0, high = 0;
  for (size_t i = 1; i < n; i++) {
    if (gradient[i] < gradient[low]) low = i;
    if (gradient[i] > gradient[high]) high = i;
  }
  if (n < 2 || fit->forchheimer || !(gradient[low] > 0.0) || !(velocity[low] > 0.0)) return;
  const double fall = 1.0 - velocity[high] / gradient[high] / (velocity[low] / gradient[low]);
  const double both = hypot(error[low] / velocity[low], error[high] / velocity[high]);
  if (fall > 0.01 && fall > both)
    log_warning("%s: k falls by %s %% from a gradient of %.4g to %.4g, more than the runs' errors: "
                "inertia is felt there; Darcy's k is that of the lower gradients alone",
                run, percent_format(fall, text), gradient[low], gradient[high]);
}

static enum status fit_group(struct darcy_table *table, size_t g) {
  enum status status = STATUS_OK;
  double *columns = NULL;
  size_t count = 0;
  const struct run *run = table->first[g];
  TRY(memory_allocate(&columns, 3 * table->n, sizeof *columns, "fit"));
  double *gradient = columns, *velocity = columns + table->n, *error = columns + 2 * table->n;
  for (size_t i = 0; i < table->n; i++) {
    const struct point *point = &table->points[i];
    if (point->group != g || !point->average.without_drift) continue;
    gradient[count] = point->gradient;
    velocity[count] = point->average.mean;
    error[count++] = point->average.error95;
  }
  if (count > 0)
    TRY(darcy_fit(gradient, velocity, error, count, run->viscosity / run->density,
                  run_driving(run) / run->hydraulic_gradient, &table->fits[g]));
  const struct darcy_fit *fit = &table->fits[g];
  if (fit->b + fit->b_error < 0.0 && fit->curvature < -0.01)
    log_warning("%s: k grows with the gradient (by %.1f %% up to the highest), which no "
                "Forchheimer term gives: look at compressibility and at pinning of particles",
                run->name, -100.0 * fit->curvature);
  else
    warn_of_inertia(gradient, velocity, error, count, fit, run->name);
cleanup:
  memory_free(&columns);
  return status;
}

/* Parts of the error of the group's first run; for several runs the averaging part is the error of
 * the fit. */
static struct uncertainty uncertainty_of(const struct run *run, const struct darcy_fit *fit) {
  struct uncertainty uncertainty;
  uncertainty_read(run, &uncertainty);
  if (fit->count > 1 || isnan(uncertainty.averaging))
    uncertainty.averaging = fit->count > 0 ? fit->k_error / fit->k : NAN;
  return uncertainty;
}

/* Relative error of the group's k from all parts. */
static double total_error(const struct run *run, const struct darcy_fit *fit) {
  const struct uncertainty uncertainty = uncertainty_of(run, fit);
  return fit->k != 0 ? uncertainty_total(&uncertainty) : NAN; /* no relative error of 0 */
}

static void fit_json(const struct run *run, const struct darcy_fit *fit, json_t *object) {
  bool ok = fit->count > 0;
  const double error = ok ? total_error(run, fit) : NAN;
  json_put_number(object, "k_m_per_s", ok ? fit->k : NAN);
  json_put_number(object, "k_cm_per_s", ok ? 100.0 * fit->k : NAN);
  json_put_number(object, "k_error_m_per_s", ok ? error * fit->k : NAN);
  json_put_number(object, "k_relative_error", error);
  json_put_number(object, "fit_relative_error", ok ? fit->k_error / fit->k : NAN);
  json_put_number(object, "intrinsic_permeability_m2", ok ? fit->intrinsic_permeability : NAN);
  json_put_number(object, "intrinsic_permeability_darcy",
                  ok ? fit->intrinsic_permeability / DARCY : NAN);
  json_put_number(object, "r_squared", ok ? fit->r_squared : NAN);
  json_object_set_new(object, "runs_in_fit", json_integer((json_int_t)fit->count));
  if (!ok) return;
  json_object_set_new(
      object, "free_fit",
      json_pack("{s:o,s:o,s:o,s:o}", "intercept_m_per_s", json_number(fit->free_intercept),
                "slope_m_per_s", json_number(fit->free_slope), "slope_error_m_per_s",
                json_number(fit->free_slope_error), "r_squared", json_number(fit->free_r_squared)));
  json_object_set_new(object, "forchheimer",
                      json_pack("{s:b,s:o,s:o,s:o}", "called_for", fit->forchheimer, "b_s2_per_m2",
                                json_number(fit->b), "b_error_s2_per_m2", json_number(fit->b_error),
                                "share_at_highest_velocity", json_number(fit->curvature)));
}

static const char superficial[] =
    "superficial (Darcy) velocity = sum of the fluid's velocity over all points / number of points "
    "of the bulk, grains included";

static void write_json(const struct darcy_table *table, json_t *json) {
  json_t *groups = json_array();
  if (table->groups == 1) {
    fit_json(table->first[0], &table->fits[0], json);
    const struct uncertainty uncertainty = uncertainty_of(table->first[0], &table->fits[0]);
    uncertainty_json(&uncertainty, json);
    if (table->has_tensor[0]) json_object_set_new(json, "tensor", tensor_json(&table->tensors[0]));
  }
  for (size_t g = 0; g < table->groups; g++) {
    char name[400];
    json_t *group = json_object(), *rows = json_array();
    const struct run *first = table->first[g];
    run_group_name(first, name, sizeof name);
    json_object_set_new(group, "name", json_text(name));
    fit_json(table->first[g], &table->fits[g], group);
    const struct uncertainty uncertainty = uncertainty_of(first, &table->fits[g]);
    uncertainty_json(&uncertainty, group);
    json_put_number(group, "viscosity_pa_s", first->viscosity);
    json_put_number(group, "density_kg_per_m3", first->density);
    for (size_t i = 0; i < table->n; i++) {
      const struct point *point = &table->points[i];
      const struct average *average = &point->average;
      if (point->group != g) continue;
      json_array_append_new(
          rows,
          json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:b,s:o,s:I}", "path",
                    json_text(table->runs[i].path), "name", json_text(table->runs[i].name),
                    "hydraulic_gradient", json_number(point->gradient), "darcy_velocity_m_per_s",
                    json_number(average->mean), "darcy_velocity_error_m_per_s",
                    json_number(average->error95), "k_m_per_s", json_number(point->k),
                    "drift_m_per_s", json_number(average->drift), "steady", average->without_drift,
                    "averaged_from_s", json_number(average->from_time), "averaged_rows",
                    (json_int_t)average->rows));
    }
    json_object_set_new(group, "runs", rows);
    if (table->has_tensor[g]) json_object_set_new(group, "tensor", tensor_json(&table->tensors[g]));
    json_array_append_new(groups, group);
  }
  json_object_set_new(json, "groups", groups);
  json_object_set_new(json, "superficial_velocity", json_string(superficial));
}

static void write_csv(const struct darcy_table *table, FILE *stream) {
  fputs("group,run,hydraulic_gradient,darcy_velocity_m_per_s,error95_m_per_s,k_m_per_s,steady,"
        "averaged_from_s\n",
        stream);
  for (size_t i = 0; i < table->n; i++) {
    const struct point *point = &table->points[i];
    fprintf(stream, "%zu,", point->group + 1);
    csv_text(stream, table->runs[i].name);
    fprintf(stream, ",%.10g,%.10g,%.6g,%.10g,%d,%.6g\n", point->gradient, point->average.mean,
            point->average.error95, point->k, point->average.without_drift,
            point->average.from_time);
  }
}

/* Writes k of a group with its error. */
static void write_fit(const struct run *first, const struct darcy_fit *fit, FILE *stream) {
  if (fit->count == 0) {
    fputs("  k: none, since every run still drifts; run longer\n\n", stream);
    return;
  }
  if (fit->k == 0) {
    fputs("  k = 0: no pore leads through along the force\n\n", stream);
    return;
  }
  const double scale = fit->intrinsic_permeability / fit->k;
  const double error = total_error(first, fit) * fit->k;
  fputs("  k = ", stream);
  write_value_with_error(stream, 100.0 * fit->k, 100.0 * error, "+-", " cm/s");
  fputs("\n    = ", stream);
  write_value_with_error(stream, fit->k, error, "+-", " m/s");
  fputs("\n  intrinsic permeability = ", stream);
  write_value_with_error(stream, fit->intrinsic_permeability, scale * error, "+-", " m^2");
  fputs("\n    = ", stream);
  write_value_with_error(stream, fit->intrinsic_permeability / DARCY, scale * error / DARCY, "+-",
                         " darcy");
  fprintf(stream, "\n  for the fluid of the runs: viscosity %g Pa s, density %g kg/m^3\n",
          first->viscosity, first->density);
  const struct uncertainty uncertainty = uncertainty_of(first, fit);
  uncertainty_write(&uncertainty, stream);
  if (isfinite(fit->r_squared))
    fprintf(stream, "  line through the origin: R^2 = %.6f\n", fit->r_squared);
  if (isfinite(fit->free_slope))
    fprintf(stream, "  free line: v = %.4g + %.6g i m/s\n", fit->free_intercept, fit->free_slope);
  if (fit->forchheimer)
    fprintf(stream,
            "  Forchheimer: i = v/k + b v^2, b = %.4g +- %.2g s^2/m^2 (%.1f %% of the "
            "highest gradient); k above is this fit's\n",
            fit->b, fit->b_error, 100.0 * fit->curvature);
  else if (isfinite(fit->b))
    fputs("  Forchheimer term: not called for by the data\n", stream);
  fputc('\n', stream);
}

static void write_summary(const struct darcy_table *table, FILE *stream) {
  if (table->groups > 1)
    fprintf(stream,
            "%zu groups of runs that may not be mixed (model, fluid, method, wall or direction "
            "differ); each is fitted by itself.\n\n",
            table->groups);
  for (size_t g = 0; g < table->groups; g++) {
    const struct darcy_fit *fit = &table->fits[g];
    char name[400];
    run_group_name(table->first[g], name, sizeof name);
    fprintf(stream, "%s\n  %-26s %10s %14s %9s %12s  %s\n", name, "run", "gradient", "v (m/s)",
            "+- 95 %", "k (cm/s)", "averaged");
    for (size_t i = 0; i < table->n; i++) {
      const struct point *point = &table->points[i];
      if (point->group != g) continue;
      fprintf(stream, "  %-26.60s %10.5g %14.6g ", table->runs[i].name, point->gradient,
              point->average.mean);
      if (point->average.mean == 0)
        fprintf(stream, "%9s", "-");
      else if (isfinite(point->average.error95))
        fprintf(stream, "%7.2f %%", 100.0 * point->average.error95 / fabs(point->average.mean));
      else
        fprintf(stream, "%9s", "unknown");
      fprintf(stream, " %12.5g  ", 100.0 * point->k);
      if (!point->average.without_drift)
        fputs("DRIFTS, left out\n", stream);
      else if (point->average.rows == 1)
        fputs("one value\n", stream);
      else
        fprintf(stream, "from %.4g s, %zu rows\n", point->average.from_time, point->average.rows);
    }
    write_fit(table->first[g], fit, stream);
    if (table->has_tensor[g]) tensor_summary(&table->tensors[g], stream);
    if (table->has_tensor[g] && g + 1 < table->groups) fputc('\n', stream);
  }
  if (log_level() >= LOG_VERBOSE) fprintf(stream, "%s\n", superficial);
}

/* v at a gradient by the fit: the root of i = v/k + b v^2, or k i. */
static double fitted(const struct darcy_fit *fit, double gradient) {
  if (!fit->forchheimer) return fit->k * gradient;
  return (sqrt(1.0 / (fit->k * fit->k) + 4.0 * fit->b * gradient) - 1.0 / fit->k) / (2.0 * fit->b);
}

static void draw(const struct darcy_table *table, json_t *charts) {
  enum { POINTS = 60 };
  json_t *chart = chart_add(charts, "Darcy velocity", "Hydraulic gradient (-)",
                            "Darcy velocity (cm/s)", CHART_ZERO, CHART_OPEN);
  for (size_t g = 0; g < table->groups; g++) {
    const struct darcy_fit *fit = &table->fits[g];
    char name[400], line[600];
    double widest = 0.0;
    run_group_name(table->first[g], name, sizeof name);
    json_t *dots = chart_series(chart, name, CHART_DOTS, (int)g, 0);
    for (size_t i = 0; i < table->n; i++) {
      const struct point *point = &table->points[i];
      const double v = 100.0 * point->average.mean, error = 100.0 * point->average.error95;
      if (point->group != g) continue;
      chart_interval(dots, point->gradient, v, v - error, v + error);
      widest = fmax(widest, point->gradient);
    }
    if (fit->count == 0) continue;
    snprintf(line, sizeof line, "%s: k = %.3g cm/s", name, 100.0 * fit->k);
    json_t *curve = chart_series(chart, line, CHART_LINE, (int)g, 0);
    for (int i = 0; i <= POINTS; i++) {
      const double gradient = 1.05 * widest * i / POINTS;
      chart_point(curve, gradient, 100.0 * fitted(fit, gradient));
    }
  }
}

static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  enum status status = STATUS_OK;
  const struct run *runs = subject->runs;
  const size_t n = subject->n;
  (void)options;
  struct darcy_table table = {.runs = runs, .n = n};
  TRY(collect(&table));
  for (size_t g = 0; g < table.groups; g++) TRY(fit_group(&table, g));
  TRY(memory_allocate(&table.tensors, table.groups, sizeof *table.tensors, "tensors"));
  TRY(memory_allocate(&table.has_tensor, table.groups, sizeof *table.has_tensor, "tensors"));
  for (size_t i = 0; i < n; i++) {
    const size_t g = table.points[i].group;
    if (!table.has_tensor[g]) TRY(tensor_read(&runs[i], &table.tensors[g], &table.has_tensor[g]));
  }
  write_json(&table, product->json);
  write_csv(&table, product->csv.stream);
  write_summary(&table, product->summary.stream);
  draw(&table, product->charts);
cleanup:
  memory_free(&table.points);
  memory_free(&table.fits);
  memory_free(&table.first);
  memory_free(&table.tensors);
  memory_free(&table.has_tensor);
  return status;
}

static enum status applies(const struct subject *subject, bool *applies) {
  *applies = subject->permeable > 0;
  return STATUS_OK;
}

/* A line through a single point says nothing. */
static bool shown(const struct subject *subject, const json_t *json) {
  size_t i;
  const json_t *group;
  (void)subject;
  json_array_foreach(json_object_get(json, "groups"), i, group) {
    if (json_array_size(json_object_get(group, "runs")) > 1) return true;
  }
  return false;
}

const struct analysis darcy_analysis = {
    .name = "darcy",
    .command = {"darcy", "RUN... [-o DIR]",
                "permeability with its error: Darcy velocity against gradient",
                "analyze darcy dense-1G.hdf dense-5G.hdf dense-10G.hdf -o results", 1, -1},
    .heading = "Darcy's law",
    .caption = "Darcy velocity against hydraulic gradient with the fitted line.",
    .page_runs = OF_PERMEABLE,
    .applies = applies,
    .analyze = analyze,
    .shown = shown};
