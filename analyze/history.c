/* History of a run: maximum density, Darcy velocity and further columns that its scene records. */

#include <ctype.h>
#include <math.h>
#include <string.h>

#include "analyze/analysis.h"
#include "analyze/averaging.h"
#include "analyze/chart.h"
#include "analyze/pdf.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/statistics.h"
#include "common/text.h"
#include "common/units.h"

struct run_history {
  const struct run *run;
  size_t rows;
  double *times, *velocity; /* velocity along the driving force */
  bool stationary;          /* stationary solution: rows are iterations, `times` their numbers */
  struct average average;
  /* Highest density_max over the reference density, 1.08 for 8 %; NAN: unknown. */
  double density_peak;
  double density_mean; /* mean of the last snapshot over the reference density; NAN: unknown */
  /* Distribution of density / reference in the last snapshot; no bins if all are equal. */
  struct pdf density;
};

static enum status measure(const struct run *run, struct run_history *h) {
  enum status status = STATUS_OK;
  struct particles particles = {0};
  h->run = run;
  h->density_peak = h->density_mean = NAN;
  TRY(run_darcy_series(run, &h->rows, &h->times, &h->velocity));
  const struct history_column *step = run_column(run, "step", 1);
  h->stationary = strcmp(run->method, "stokes") == 0;
  if (h->stationary)
    TRY(average_darcy(run, &h->average));
  else
    TRY(average_record(h->times, h->velocity, h->rows, &h->average));
  for (size_t i = 0; h->stationary && step != NULL && i < h->rows; i++)
    h->times[i] = step->values[i];
  const struct history_column *density = run_column(run, "density_max", 1);
  for (size_t i = 0; density != NULL && i < density->rows; i++)
    if (isfinite(density->values[i]))
      h->density_peak = fmax(h->density_peak, density->values[i] / run->density);
  if (run->snapshot_count == 0) {
    log_warning("%s: the run lists no snapshots, so there is no density histogram", run->path);
    return STATUS_OK;
  }
  TRY(run_last_snapshot(run, &particles));
  if (particles.density == NULL) goto cleanup;
  double sum = 0.0;
  for (size_t i = 0; i < particles.count; i++) {
    particles.density[i] /= run->density;
    sum += particles.density[i];
  }
  h->density_mean = sum / (double)particles.count;
  if (quantile(particles.density, particles.count, 1.0) -
          quantile(particles.density, particles.count, 0.0) >
      1e-9)
    TRY(pdf_estimate(particles.density, particles.count, &h->density));
cleanup:
  particles_free(&particles);
  return status;
}

#define SERIES_ROWS 600 /* drawn at most */

/* Columns of every run; all others were added by the scene (gauges, planes, volumes). */
static bool is_standard(const char *column) {
  static const char *const names[] = {
      "time",         "step",     "dt",   "darcy_velocity", "density_max",
      "density_mean", "momentum", "mass", "kinetic_energy", "reynolds"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strcmp(column, names[i]) == 0) return true;
  return false;
}

static void fill_json(const struct run_history *h, json_t *object) {
  const struct average *s = &h->average;
  json_object_set_new(object, "path", json_text(h->run->path));
  json_object_set_new(object, "name", json_text(h->run->name));
  json_object_set_new(object, "method", json_text(h->run->method));
  json_object_set_new(object, "status", json_text(h->run->status));
  json_object_set_new(object, "rows", json_integer((json_int_t)h->rows));
  json_object_set_new(object, "dimensions", json_integer(h->run->dimensions));
  json_object_set_new(object, "stationary", json_boolean(h->stationary));
  json_object_set_new(object, h->stationary ? "iterations" : "end_time_s",
                      json_number(h->times[h->rows - 1]));
  json_object_set_new(object, "steady", json_boolean(s->without_drift));
  json_put_number(object, "steady_from_s", s->from_time);
  json_put_number(object, "darcy_velocity_m_per_s", s->mean);
  json_put_number(object, "darcy_velocity_error_m_per_s", s->error95);
  json_put_number(object, "drift_m_per_s", s->drift);
  json_put_number(object, "density_max_rise_percent", 100.0 * (h->density_peak - 1.0));
  json_put_number(object, "density_mean_rise_percent", 100.0 * (h->density_mean - 1.0));
  if (h->density.bins > 0)
    json_object_set_new(object, "density_histogram",
                        json_pack("{s:o,s:o}", "bin_edges",
                                  json_numbers(h->density.edges, h->density.bins + 1), "density",
                                  json_numbers(h->density.density, h->density.bins)));
  json_t *extra = json_object();
  for (size_t c = 0; c < h->run->column_count; c++) {
    const struct history_column *column = &h->run->columns[c];
    if (is_standard(column->name) || column->rows == 0) continue;
    size_t components = (size_t)column->components;
    json_object_set_new(
        extra, column->name,
        json_pack("{s:o,s:o}", "unit", json_text(column->unit), "last",
                  json_numbers(&column->values[(column->rows - 1) * components], components)));
  }
  json_object_set_new(object, "columns", extra);
}

/* One row per time with every column, vectors as NAME_x, NAME_y, NAME_z. */
static void write_csv(const struct run *runs, size_t n, FILE *stream) {
  for (size_t r = 0; r < n; r++) {
    const struct run *run = &runs[r];
    const struct history_column *time = run_column(run, "time", 1);
    if (r > 0) fputc('\n', stream);
    fputs("run,time", stream);
    for (size_t c = 0; c < run->column_count; c++) {
      const struct history_column *column = &run->columns[c];
      if (column == time) continue;
      for (int d = 0; d < column->components; d++) {
        fputc(',', stream);
        csv_text(stream, column->name);
        if (column->components == 3) fprintf(stream, "_%c", 'x' + d);
      }
    }
    fputc('\n', stream);
    for (size_t i = 0; i < time->rows; i++) {
      csv_text(stream, run->name);
      fprintf(stream, ",%.10g", time->values[i]);
      for (size_t c = 0; c < run->column_count; c++) {
        const struct history_column *column = &run->columns[c];
        for (int d = 0; column != time && d < column->components; d++)
          fprintf(stream, ",%.10g",
                  text_number(column->values[i * (size_t)column->components + (size_t)d]));
      }
      fputc('\n', stream);
    }
  }
}

static void write_summary(const struct run_history *table, size_t n, FILE *stream) {
  fprintf(stream, "  %-26s %14s %14s %14s %9s %12s %11s\n", "run", "end", "mean from", "v (m/s)",
          "+- 95 %", "max density", "status");
  for (size_t i = 0; i < n; i++) {
    const struct run_history *h = &table[i];
    char end[32], from[32] = "drifts", density[32] = "-", error[40] = "unknown", text[32];
    snprintf(end, sizeof end, h->stationary ? "%.4g iterations" : "%.4g s", h->times[h->rows - 1]);
    if (h->stationary || strcmp(h->run->status, "blocked") == 0)
      snprintf(from, sizeof from, "stationary");
    else if (h->average.without_drift)
      snprintf(from, sizeof from, "%.4g s", h->average.from_time);
    if (isfinite(h->density_peak))
      snprintf(density, sizeof density, "%+.2f %%", 100.0 * (h->density_peak - 1.0));
    if (h->average.mean == 0)
      snprintf(error, sizeof error, "-");
    else if (h->average.error95 > fabs(h->average.mean)) /* it oscillates about zero */
      snprintf(error, sizeof error, "over 100 %%");
    else if (isfinite(h->average.error95))
      snprintf(error, sizeof error, "%s %%",
               percent_format(h->average.error95 / fabs(h->average.mean), text));
    fprintf(stream, "  %-26.60s %14s %14s %14.6g %9s %12s %11s\n", h->run->name, end, from,
            h->average.mean, error, density, h->run->status);
  }
}

/* The kind of a column that the scene asks for, NAME of NAME_PLACE: its length; 0 for a record of
 * the solver. */
static size_t kind_of(const char *column) {
  static const char *const kinds[] = {
      "head",         "level",  "flux",    "force",  "pressure", "velocity", "water_content",
      "infiltration", "inflow", "entered", "fallen", "ran_off",  "ponded"};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    const size_t length = strlen(kinds[i]);
    if (strncmp(column, kinds[i], length) == 0 && column[length] == '_' &&
        strncmp(column + length, "_rms", 4) != 0)
      return length;
  }
  return 0;
}

/* The first `length` characters of a column's name, in words: "pressure_open" as "pressure open".
 */
static void name_in_words(const char *column, size_t length, char *text, size_t size) {
  snprintf(text, length < size ? length + 1 : size, "%s", column);
  for (char *at = text; *at != '\0'; at++)
    if (*at == '_') *at = ' ';
}

/* Adds every so many rows of a component of a column, so that no more than SERIES_ROWS are drawn.
 */
static void draw_rows(json_t *series, const struct run_history *h, double time_scale,
                      const double *values, size_t stride, double scale, double offset) {
  const size_t step = (h->rows + SERIES_ROWS - 1) / SERIES_ROWS;
  for (size_t r = 0; r < h->rows; r += step)
    chart_point(series, h->times[r] * time_scale, values[r * stride] * scale - offset);
}

/* Whether all values are positive and span more than three decades, as with residuals. */
static bool spans_decades(const struct history_column *column) {
  double low = INFINITY, high = 0.0;
  for (size_t i = 0; i < column->rows * (size_t)column->components; i++) {
    if (!isfinite(column->values[i])) continue;
    low = fmin(low, column->values[i]);
    high = fmax(high, column->values[i]);
  }
  return low > 0.0 && high > 1e3 * low;
}

/* Adds the components of a column of all runs to a chart: not y in two dimensions. */
static void draw_column(json_t *chart, const struct run_history *table, size_t n,
                        const struct history_column *column, size_t kind, double time_scale) {
  for (size_t i = 0; i < n; i++) {
    const struct history_column *own = run_column(table[i].run, column->name, column->components);
    const bool vector = column->components > 1;
    for (size_t d = 0; own != NULL && d < (size_t)own->components; d++) {
      char name[500], place[200] = "";
      if (vector && d == 1 && table[i].run->dimensions == 2) continue;
      if (kind > 0) name_in_words(own->name + kind + 1, sizeof place, place, sizeof place);
      const char *region = isdigit((unsigned char)place[0]) ? "region " : "";
      const char *of = n > 1 || (kind == 0 && !vector) ? table[i].run->name : "";
      snprintf(name, sizeof name, "%.200s%s%s%.200s%s%.*s", of, *of && *place ? ", " : "", region,
               place, vector && (*of || *place) ? ", " : "", vector ? 1 : 0, &"xyz"[d]);
      const int colour = (int)json_array_size(json_object_get(chart, "series"));
      draw_rows(chart_series(chart, name, CHART_LINE, colour, 0), &table[i], time_scale,
                own->values + d, (size_t)own->components, 1.0, 0.0);
    }
  }
}

/* What the scene asks for is shown openly, a chart for all places of a kind; without it where free
 * water is and how fast. The solver's own records are folded. The works of the energy budget are a
 * table (/run/ledger). Returns whether a chart is open. */
static bool draw_columns(const struct run_history *table, size_t n, bool free, const char *time,
                         double time_scale, json_t *charts) {
  const struct run *run = table[0].run;
  bool asked = false, open = false;
  for (size_t c = 0; c < run->column_count; c++) asked |= kind_of(run->columns[c].name) > 0;
  for (size_t c = 0; c < run->column_count; c++) {
    const struct history_column *column = &run->columns[c];
    const size_t kind = kind_of(column->name);
    const bool where =
        strcmp(column->name, "front_high") == 0 || strcmp(column->name, "velocity_rms") == 0;
    const bool shown = kind > 0 || (free && where && !asked);
    const bool none = strcmp(column->unit, "1") == 0 || column->unit[0] == '\0';
    char title[200], label[300];
    if (is_standard(column->name) || strncmp(column->name, "work_", 5) == 0) continue;
    name_in_words(column->name, kind > 0 ? kind : strlen(column->name), title, sizeof title);
    title[0] = (char)toupper((unsigned char)title[0]);
    snprintf(label, sizeof label, "%s (%.60s)", title, none ? "-" : column->unit);
    json_t *chart = chart_find(charts, title);
    if (chart == NULL)
      chart =
          chart_add(charts, title, time, label, spans_decades(column) ? CHART_LOG_Y : CHART_PLAIN,
                    shown ? CHART_OPEN : CHART_FOLDED);
    draw_column(chart, table, n, column, kind, time_scale);
    open |= shown;
  }
  return open;
}

static void draw(const struct run_history *table, size_t n, bool free, json_t *charts) {
  double longest = 0.0;
  bool rises = false;
  const bool iterations = table[0].stationary;
  for (size_t i = 0; i < n; i++) {
    longest = fmax(longest, table[i].times[table[i].rows - 1]);
    rises |= fabs(table[i].density_peak - 1.0) > 1e-9; /* false for NAN */
  }
  const bool brief = longest<0.1, hours = longest> 7200.0;
  const double scale = iterations ? 1.0 : brief ? 1e3 : hours ? 1.0 / 3600.0 : 1.0;
  const char *time = iterations ? "Iteration"
                     : brief    ? "Time (ms)"
                     : hours    ? "Time (h)"
                                : "Time (s)";
  const enum chart_place place =
      draw_columns(table, n, free, time, scale, charts) ? CHART_FOLDED : CHART_OPEN;
  json_t *velocity =
      chart_add(charts, "Darcy velocity", time, "Darcy velocity (cm/s)", CHART_PLAIN, place);
  json_t *peak = chart_add(charts, "Maximum density", time, "Maximum density above reference (%)",
                           CHART_PLAIN, place);
  json_t *end = chart_add(charts, "Density at the end", "Density above reference (%)",
                          "Probability density (1/%)", CHART_ZERO, CHART_FOLDED);
  for (size_t i = 0; i < n; i++) {
    const struct run_history *h = &table[i];
    const struct history_column *density = run_column(h->run, "density_max", 1);
    draw_rows(chart_series(velocity, h->run->name, CHART_LINE, (int)i, 0), h, scale, h->velocity, 1,
              100.0, 0.0);
    if (density != NULL && rises && !h->stationary)
      draw_rows(chart_series(peak, h->run->name, CHART_LINE, (int)i, 0), h, scale, density->values,
                1, 100.0 / h->run->density, 100.0);
    chart_steps(chart_series(end, h->run->name, CHART_LINE, (int)i, 0), h->density.bins,
                h->density.edges, h->density.density, 100.0, 100.0);
  }
}

static enum status analyze(const struct subject *subject, const struct options *options,
                           struct product *product) {
  enum status status = STATUS_OK;
  const struct run *runs = subject->runs;
  const size_t n = subject->n;
  (void)options;
  struct run_history *table = NULL;
  TRY(memory_allocate(&table, n, sizeof *table, "runs"));
  for (size_t i = 0; i < n; i++) {
    TRY(measure(&runs[i], &table[i]));
    json_t *object = json_object();
    fill_json(&table[i], object);
    product_add_run(product, object, n);
  }
  write_csv(runs, n, product->csv.stream);
  write_summary(table, n, product->summary.stream);
  draw(table, n, subject->permeable == 0, product->charts);
cleanup:
  for (size_t i = 0; table != NULL && i < n; i++) {
    memory_free(&table[i].times);
    memory_free(&table[i].velocity);
    pdf_free(&table[i].density);
  }
  memory_free(&table);
  return status;
}

/* A record of a few rows, or of iterations, says nothing. */
static bool shown(const struct subject *subject, const json_t *json) {
  (void)json;
  for (size_t i = 0; i < subject->n; i++) {
    const struct run *run = &subject->runs[i];
    if (run->column_count > 0 && run->columns[0].rows >= 10 && strcmp(run->method, "stokes") != 0)
      return true;
  }
  return false;
}

const struct analysis history_analysis = {
    .name = "history",
    .command = {"history", "RUN... [-o DIR]",
                "Darcy velocity, density and gauges against time; steadiness",
                "analyze history dense-1G.hdf -o results", 1, -1},
    .heading = "History",
    .caption = "What the scene records, against time; what the solver records is folded.",
    .analyze = analyze,
    .shown = shown};
