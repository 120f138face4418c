/* Dispersion of a solute against the Peclet number, from runs of method solute. */
#include <math.h>
#include <string.h>

#include "analyze/analysis.h"
#include "analyze/chart.h"
#include "common/hdf5_file.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/text.h"

enum { LONGITUDINAL, TRANSVERSE, LONGITUDINAL_ERROR, TRANSVERSE_ERROR, COLUMNS };
static const char *const column_names[COLUMNS] = {"longitudinal", "transverse",
                                                  "longitudinal_error", "transverse_error"};
static const char *const way_names[] = {"closure", "walk"};
enum { WAYS = 2 };

/* Parts of the errors, relative. The error is the root of the sum of squares of the first four. The
 * error due to the sample's size is reported separately, and the last part is its share from
 * repeating the sample. */
enum { PARTS = 6, DIRECTIONS = 2 };
static const char *const part_names[PARTS] = {"resolution",  "projection", "statistics",
                                              "asymptotics", "sample",     "repeats"};
static const char *const part_words[PARTS] = {
    "resolution",  "projection",  "statistics",
    "asymptotics", "sample size", "of the sample's size, from repeating it"};

/* D* over D by one method, or the reported values; arrays of `count`. */
struct curve {
  bool there;
  /* A part is NULL if the method does not have it. */
  double *column[COLUMNS], *part[DIRECTIONS][PARTS];
};

struct solute_run {
  const char *path;
  char *name, *flow;
  size_t count;
  double *peclet;
  struct curve best, way[WAYS];
  double length, diffusion, porosity, speed, formation, formation_error, tortuosity, grain_size;
  double formation_sample, correlation[2]; /* NAN in files of older versions */
  bool mirrored;                           /* along the flow */
};

static enum status read_curve(struct h5_file *file, const char *group, size_t count,
                              struct curve *curve) {
  enum status status = STATUS_OK;
  for (int c = 0; c < COLUMNS; c++) {
    char path[128];
    size_t n;
    snprintf(path, sizeof path, "%s/%s", group, column_names[c]);
    if (!h5_exists(file, path)) goto cleanup;
    TRY(h5_read(file, path, H5_F64, 1, &n, &curve->column[c]));
    if (n != count)
      TRY_FAIL(STATUS_INPUT, "%s: %s has %zu values, not %zu as there are Peclet numbers",
               h5_path(file), path, n, count);
  }
  for (int d = 0; d < DIRECTIONS; d++)
    for (int p = 0; p < PARTS; p++) {
      char path[128];
      size_t n;
      snprintf(path, sizeof path, "%s/%s_%s", group, column_names[d], part_names[p]);
      if (!h5_exists(file, path)) continue;
      TRY(h5_read(file, path, H5_F64, 1, &n, &curve->part[d][p]));
      if (n != count) memory_free(&curve->part[d][p]);
    }
  curve->there = true;
cleanup:
  return status;
}

static enum status read_run(const char *path, struct solute_run *run) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  run->path = path;
  TRY(h5_open(path, &file));
  if (!h5_exists(file, "/solute"))
    TRY_FAIL(STATUS_INPUT,
             "%s: no solute in it; give the OUT.hdf of a scene with flow = { file = ...; } and "
             "solute = { ... }",
             path);
  TRY(h5_read(file, "/solute/peclet", H5_F64, 1, &run->count, &run->peclet));
  TRY(read_curve(file, "/solute", run->count, &run->best));
  if (!run->best.there) TRY_FAIL(STATUS_INPUT, "%s: /solute holds no coefficients", path);
  for (int w = 0; w < WAYS; w++) {
    char group[64];
    snprintf(group, sizeof group, "/solute/%s", way_names[w]);
    TRY(read_curve(file, group, run->count, &run->way[w]));
  }
  if (h5_attribute_exists(file, "/run", "scene_name"))
    TRY(h5_read_attribute_text(file, "/run", "scene_name", &run->name));
  if (run->name != NULL) text_make_plain(run->name);
  if (h5_attribute_exists(file, "/solute", "flow"))
    TRY(h5_read_attribute_text(file, "/solute", "flow", &run->flow));
  run->length = h5_attribute_or_nan(file, "/solute", "length");
  run->diffusion = h5_attribute_or_nan(file, "/solute", "diffusion");
  run->porosity = h5_attribute_or_nan(file, "/solute", "porosity");
  run->speed = h5_attribute_or_nan(file, "/solute", "speed");
  run->formation = h5_attribute_or_nan(file, "/solute", "formation_factor");
  run->formation_error = h5_attribute_or_nan(file, "/solute", "formation_factor_error");
  run->formation_sample = h5_attribute_or_nan(file, "/solute", "formation_factor_sample");
  run->correlation[0] = run->correlation[1] = NAN;
  if (h5_attribute_exists(file, "/solute", "correlation_length"))
    TRY(h5_read_attribute(file, "/solute", "correlation_length", H5_F64, 2, run->correlation));
  run->tortuosity = h5_attribute_or_nan(file, "/solute", "tortuosity");
  run->grain_size = h5_attribute_or_nan(file, "/solute", "grain_size");
  run->mirrored = h5_attribute_or_nan(file, "/solute", "mirrored") > 0;
cleanup:
  h5_close(file);
  return status;
}

static void free_parts(struct curve *curve) {
  for (int d = 0; d < DIRECTIONS; d++)
    for (int p = 0; p < PARTS; p++) memory_free(&curve->part[d][p]);
}

static void free_run(struct solute_run *run) {
  free_parts(&run->best);
  for (int w = 0; w < WAYS; w++) free_parts(&run->way[w]);
  memory_free(&run->name);
  memory_free(&run->flow);
  memory_free(&run->peclet);
  for (int c = 0; c < COLUMNS; c++) {
    memory_free(&run->best.column[c]);
    for (int w = 0; w < WAYS; w++) memory_free(&run->way[w].column[c]);
  }
}

static const char *name_of(const struct solute_run *run) {
  return run->name != NULL && *run->name ? run->name : run->path;
}

/* Dispersivity D* / U, m; NAN without flow. */
static double dispersivity(const struct solute_run *run, size_t i, double over_diffusion) {
  return run->peclet[i] > 0 ? over_diffusion * run->length / run->peclet[i] : NAN;
}

/* Range of experiments on packed beds of beads and sand, with Pe by the grain diameter, among them
 * those collected by Pfannkuch (1963) and by Fried and Combarnous (1971, Adv. Hydrosci. 7, 169; as
 * in Sahimi 1995, "Flow and Transport in Porous Media and Fractured Rock"):
 *   longitudinal: 1 / (F porosity) + Pe^m / 2, m = 1 to 1.2, for 5 < Pe < 300; 1.8 +- 0.4 Pe beyond
 *   transverse: 1 / (F porosity) + 0.025 Pe^1.1 for 5 < Pe < 300.
 * Bijeljic, Muggeridge, Blunt (2004) find the longitudinal power 1.19 for 10 < Pe < 400. */
#define BED_PECLET_MIN 5.0
#define BED_PECLET_MIDDLE 300.0
#define BED_PECLET_MAX 1000.0
static double bed(const struct solute_run *run, double peclet) {
  return 1 / run->tortuosity + 0.5 * pow(peclet * run->grain_size / run->length, 1.2);
}

static void write_json(const struct solute_run *runs, size_t n, json_t *json) {
  json_t *list = json_array();
  for (size_t r = 0; r < n; r++) {
    const struct solute_run *run = &runs[r];
    json_t *object = json_object(), *lengths[2] = {json_array(), json_array()};
    json_t *published = json_array();
    json_object_set_new(object, "name", json_text(name_of(run)));
    json_object_set_new(object, "path", json_text(run->path));
    if (run->flow != NULL) json_object_set_new(object, "flow", json_text(run->flow));
    json_object_set_new(object, "peclet", json_numbers(run->peclet, run->count));
    for (int c = 0; c < COLUMNS; c++)
      json_object_set_new(object, column_names[c], json_numbers(run->best.column[c], run->count));
    for (size_t i = 0; i < run->count; i++) {
      for (int c = 0; c < 2; c++)
        json_array_append_new(lengths[c],
                              json_number(dispersivity(run, i, run->best.column[c][i])));
      json_array_append_new(published, json_number(bed(run, run->peclet[i])));
    }
    json_object_set_new(object, "longitudinal_dispersivity_m", lengths[0]);
    json_object_set_new(object, "transverse_dispersivity_m", lengths[1]);
    json_object_set_new(object, "longitudinal_of_beds", published);
    for (int w = 0; w < WAYS; w++) {
      json_t *way = json_object();
      for (int c = 0; c < COLUMNS && run->way[w].there; c++)
        json_object_set_new(way, column_names[c], json_numbers(run->way[w].column[c], run->count));
      for (int d = 0; d < DIRECTIONS; d++)
        for (int p = 0; p < PARTS; p++) {
          char name[64];
          snprintf(name, sizeof name, "%s_%s", column_names[d], part_names[p]);
          if (run->way[w].part[d][p] != NULL)
            json_object_set_new(way, name, json_numbers(run->way[w].part[d][p], run->count));
        }
      if (run->way[w].there)
        json_object_set_new(object, way_names[w], way);
      else
        json_decref(way);
    }
    json_put_number(object, "length_m", run->length);
    json_put_number(object, "grain_size_m", run->grain_size);
    json_put_number(object, "diffusion_m2_per_s", run->diffusion);
    json_put_number(object, "porosity", run->porosity);
    json_object_set_new(object, "mirrored", json_boolean(run->mirrored));
    json_put_number(object, "mean_velocity_m_per_s", run->speed);
    json_put_number(object, "formation_factor", run->formation);
    json_put_number(object, "formation_factor_error", run->formation_error);
    json_put_number(object, "formation_factor_sample", run->formation_sample);
    json_put_number(object, "tortuosity", run->tortuosity);
    json_put_number(object, "velocity_correlation_along_m", run->correlation[0]);
    json_put_number(object, "velocity_correlation_across_m", run->correlation[1]);
    json_array_append_new(list, object);
  }
  json_object_set_new(json, "runs", list);
}

static void write_csv(const struct solute_run *runs, size_t n, FILE *stream) {
  fputs("run,peclet,longitudinal,longitudinal_error,transverse,transverse_error,"
        "longitudinal_dispersivity_m,transverse_dispersivity_m\n",
        stream);
  for (size_t r = 0; r < n; r++)
    for (size_t i = 0; i < runs[r].count; i++) {
      double *const *column = runs[r].best.column;
      csv_text(stream, name_of(&runs[r]));
      fprintf(stream, ",%.10g,%.10g,%.4g,%.10g,%.4g,%.10g,%.10g\n", runs[r].peclet[i],
              column[LONGITUDINAL][i], column[LONGITUDINAL_ERROR][i], column[TRANSVERSE][i],
              column[TRANSVERSE_ERROR][i], dispersivity(&runs[r], i, column[LONGITUDINAL][i]),
              dispersivity(&runs[r], i, column[TRANSVERSE][i]));
    }
}

static void write_value(FILE *stream, double value, double error) {
  fprintf(stream, "  %9.4g", value);
  if (isfinite(error))
    fprintf(stream, " +- %-6.2g%%", 100 * error);
  else
    fprintf(stream, " %-11s", "");
}

/* Parts of the relative error of D_L, for each Peclet number. */
static void write_parts(const struct solute_run *run, FILE *stream) {
  for (int w = 0; w < WAYS; w++)
    for (int p = 0; p < PARTS; p++) {
      double *const *own = run->way[w].part[LONGITUDINAL];
      if (!run->way[w].there || own[p] == NULL) continue;
      fprintf(stream, "  error of D_L by %s, %s:", way_names[w], part_words[p]);
      for (size_t i = 0; i < run->count; i++) {
        fputc(' ', stream);
        if (isfinite(own[p][i]))
          write_percent(stream, own[p][i]);
        else
          fputc('?', stream);
      }
      fputc('\n', stream);
    }
}

static void write_summary(const struct solute_run *runs, size_t n, FILE *stream) {
  for (size_t r = 0; r < n; r++) {
    const struct solute_run *run = &runs[r];
    fprintf(stream, "%s\n  ", name_of(run));
    if (isfinite(run->formation)) {
      fputs("formation factor F = ", stream);
      write_value_with_error(stream, run->formation, run->formation * run->formation_error, "+-",
                             "");
      fprintf(stream, ", D*/D without flow = %.4g, ", 1 / run->tortuosity);
    }
    fprintf(stream,
            "porosity %.4f\n  Pe = U length / D with the length "
            "%.4g mm\n  %10s  %9s %10s   %9s %10s   %s\n",
            run->porosity, 1e3 * run->length, "Pe", "D_L/D", "", "D_T/D", "",
            "D_L/U (mm)  D_T/U (mm)");
    for (size_t i = 0; i < run->count; i++) {
      double *const *column = run->best.column;
      fprintf(stream, "  %10.4g", run->peclet[i]);
      write_value(stream, column[LONGITUDINAL][i], column[LONGITUDINAL_ERROR][i]);
      write_value(stream, column[TRANSVERSE][i], column[TRANSVERSE_ERROR][i]);
      if (run->peclet[i] > 0)
        fprintf(stream, "  %-10.4g  %.4g", 1e3 * dispersivity(run, i, column[LONGITUDINAL][i]),
                1e3 * dispersivity(run, i, column[TRANSVERSE][i]));
      fputc('\n', stream);
    }
    write_parts(run, stream);
    if (run->mirrored)
      fputs("  the sample is its own mirror image along the flow, which brings every streamline\n"
            "  back to its place: above Pe of some 10, D_L is more than the soil's; take a flow\n"
            "  along an axis that is not mirrored\n",
            stream);
    fputc('\n', stream);
  }
}

/* A curve against the Peclet number. Values without flow (Pe 0) and along an axis of one cell,
 * where nothing spreads, are omitted on the logarithmic axes. */
static void draw_curve(const struct solute_run *run, const struct curve *curve, int direction,
                       const char *name, int colour, int dash, json_t *chart) {
  json_t *dots = chart_series(chart, name, CHART_DOTS, colour, dash);
  for (size_t i = 0; i < run->count; i++) {
    const double value = curve->column[direction][i];
    const double error = curve->column[LONGITUDINAL_ERROR + direction][i];
    if (run->peclet[i] > 0 && value > 1e-9)
      chart_interval(dots, run->peclet[i], value, value * fmax(1 - error, 0.01),
                     value * (1 + error));
  }
}

/* The ranges of `bed` over its Peclet numbers, as lines. */
static void draw_beds(const struct solute_run *run, json_t *chart) {
  enum { ROWS = 30, LINES = 3 };
  static const char *const names[LINES] = {"published beds, along the flow: least",
                                           "published beds, along the flow: most",
                                           "published beds, across"};
  const double still = 1 / run->tortuosity, range = BED_PECLET_MAX / BED_PECLET_MIN;
  for (int line = 0; line < LINES; line++) {
    json_t *curve = chart_series(chart, names[line], CHART_LINE, CHART_GREY, line);
    for (int i = 0; i <= ROWS; i++) {
      const double grain = BED_PECLET_MIN * pow(range, (double)i / ROWS);
      const bool low = grain <= BED_PECLET_MIDDLE;
      const double values[LINES] = {low ? still + 0.5 * grain : 1.4 * grain,
                                    low ? still + 0.5 * pow(grain, 1.2) : 2.2 * grain,
                                    low ? still + 0.025 * pow(grain, 1.1) : NAN};
      chart_point(curve, grain * run->length / run->grain_size, values[line]);
    }
  }
}

static void draw(const struct solute_run *runs, size_t n, json_t *charts) {
  json_t *chart = chart_add(charts, "Dispersion", "Pe = U × length / D",
                            "Dispersion coefficient / D", CHART_LOG_XY, CHART_OPEN);
  const struct solute_run *still = NULL; /* the first run with a formation factor */
  for (size_t r = n; r-- > 0;)
    if (isfinite(runs[r].tortuosity) && runs[r].grain_size > 0) still = &runs[r];
  for (size_t r = 0; r < n; r++)
    for (int d = 0; d < DIRECTIONS; d++) {
      char name[400];
      const int colour = (int)(2 * r) + d;
      snprintf(name, sizeof name, "%s%s%s the flow", n > 1 ? name_of(&runs[r]) : "",
               n > 1 ? ", " : "", d > 0 ? "across" : "along");
      draw_curve(&runs[r], &runs[r].best, d, name, colour, 0, chart);
      if (!runs[r].way[0].there || !runs[r].way[1].there) continue;
      strncat(name, ", random walk", sizeof name - strlen(name) - 1);
      draw_curve(&runs[r], &runs[r].way[1], d, name, colour + 2, 1, chart);
    }
  if (still != NULL) draw_beds(still, chart);
}

static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  enum status status = STATUS_OK;
  const char *const *paths = subject->solutes;
  const size_t n = subject->solute_count;
  (void)options;
  struct solute_run *runs = NULL;
  TRY(memory_allocate(&runs, n, sizeof *runs, "runs of a solute"));
  for (size_t r = 0; r < n; r++) TRY(read_run(paths[r], &runs[r]));
  write_json(runs, n, product->json);
  write_csv(runs, n, product->csv.stream);
  write_summary(runs, n, product->summary.stream);
  draw(runs, n, product->charts);
cleanup:
  for (size_t r = 0; r < n && runs != NULL; r++) free_run(&runs[r]);
  memory_free(&runs);
  return status;
}

static enum status applies(const struct subject *subject, bool *applies) {
  *applies = subject->solute_count > 0;
  return STATUS_OK;
}

const struct analysis dispersion_analysis = {
    .name = "dispersion",
    .command = {"dispersion", "RUN... [-o DIR]",
                "how a solute spreads along and across the flow, against the Peclet number",
                "analyze dispersion solute.hdf -o results", 1, -1},
    .of_solutes = true,
    .heading = "Dispersion of a solute",
    .contents = "Dispersion",
    .caption = "How fast a solute spreads along and across the flow, over the molecular diffusion "
               "coefficient, against the Peclet number.",
    .applies = applies,
    .analyze = analyze};
