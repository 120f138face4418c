#include "analyze/history.h"
#include "analyze/history_plot.h"

#include <math.h>
#include <string.h>

#include "analyze/analysis.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/statistics.h"
#include "common/units.h"

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

#define SERIES_ROWS 600

/* At most SERIES_ROWS + 1 of `rows` values with the given stride, evenly spaced and including the
 * last. */
static json_t *json_thinned(const double *values, size_t stride, size_t rows) {
  json_t *array = json_array();
  size_t step = (rows + SERIES_ROWS - 1) / SERIES_ROWS;
  for (size_t i = 0; i < rows; i += step)
    json_array_append_new(array, json_number(values[i * stride]));
  if (rows > 0 && (rows - 1) % step != 0)
    json_array_append_new(array, json_number(values[(rows - 1) * stride]));
  return array;
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
  /* Series are thinned to the resolution of a plot; history.csv has all rows. */
  json_object_set_new(object, h->stationary ? "iteration" : "time_s",
                      json_thinned(h->times, 1, h->rows));
  json_object_set_new(object, "darcy_velocity_series_m_per_s",
                      json_thinned(h->velocity, 1, h->rows));
  const struct history_column *density = run_column(h->run, "density_max", 1);
  json_put_number(object, "density_reference_kg_per_m3", h->run->density);
  if (density != NULL)
    json_object_set_new(object, "density_max_series_kg_per_m3",
                        json_thinned(density->values, 1, h->rows));
  if (h->density.bins > 0)
    json_object_set_new(object, "density_histogram",
                        json_pack("{s:o,s:o}", "bin_edges",
                                  json_numbers(h->density.edges, h->density.bins + 1), "density",
                                  json_numbers(h->density.density, h->density.bins)));
  json_t *extra = json_object();
  for (size_t c = 0; c < h->run->column_count; c++) {
    const struct history_column *column = &h->run->columns[c];
    if (history_is_standard(column->name) || column->rows == 0) continue;
    size_t components = (size_t)column->components;
    json_t *series = json_array();
    for (size_t d = 0; d < components; d++)
      json_array_append_new(series, json_thinned(column->values + d, components, column->rows));
    json_object_set_new(
        extra, column->name,
        json_pack("{s:o,s:o,s:o}", "unit", json_text(column->unit), "last",
                  json_numbers(&column->values[(column->rows - 1) * components], components),
                  "series", series));
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
          fprintf(stream, ",%.10g", column->values[i * (size_t)column->components + (size_t)d]);
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
  history_plot(table, n, product);
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
    .contents = "History",
    .caption = "Darcy velocity and density against time, the density's histogram at the end, and "
               "what the scene records.",
    .charts = true,
    .analyze = analyze,
    .shown = shown};
