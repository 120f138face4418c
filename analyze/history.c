#include "analyze/history.h"

#include <math.h>
#include <string.h>

#include "analyze/pdf.h"
#include "analyze/plot.h"
#include "analyze/steady.h"
#include "common/log.h"
#include "common/memory.h"

/* Columns every run has; all others were added by the scene (gauges, planes, volumes). */
static bool is_standard(const char *name) {
  static const char *const names[] = {
      "time",         "step",     "dt",   "darcy_velocity", "density_max",
      "density_mean", "momentum", "mass", "kinetic_energy", "reynolds"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strcmp(name, names[i]) == 0) return true;
  return false;
}

struct run_history {
  const struct run *run;
  size_t rows;
  double *times, *velocity; /* along the driving force */
  struct steady steady;
  double density_peak; /* highest density_max over the reference, 1.08: 8 %; NAN if unknown */
  double density_mean; /* of the last snapshot over the reference; NAN if unknown */
  struct pdf density;  /* of the last snapshot's density / reference; no bins if unknown */
};

static enum status measure(const struct run *run, struct run_history *h) {
  enum status status = STATUS_OK;
  struct particles particles = {0};
  h->run = run;
  h->density_peak = h->density_mean = NAN;
  TRY(run_darcy_series(run, &h->rows, &h->times, &h->velocity));
  if (strcmp(run->method, "stokes") == 0 &&
      run->direction[0] + run->direction[1] + run->direction[2] != 0.0)
    TRY(steady_darcy(run, &h->steady));
  else
    TRY(steady_find(h->times, h->velocity, h->rows, &h->steady));
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
  TRY(pdf_estimate(particles.density, particles.count, &h->density));
cleanup:
  particles_free(&particles);
  return status;
}

#define SERIES_ROWS 600

/* Every so-manieth of `rows` values `stride` apart, and the last. */
static json_t *json_thinned(const double *values, size_t stride, size_t rows) {
  json_t *array = json_array();
  size_t step = (rows + SERIES_ROWS - 1) / SERIES_ROWS;
  for (size_t i = 0; i < rows; i += step)
    json_array_append_new(array, json_number(values[i * stride]));
  if ((rows - 1) % step != 0)
    json_array_append_new(array, json_number(values[(rows - 1) * stride]));
  return array;
}

static void fill_json(const struct run_history *h, json_t *object) {
  const struct steady *s = &h->steady;
  json_object_set_new(object, "path", json_text(h->run->path));
  json_object_set_new(object, "name", json_text(h->run->name));
  json_object_set_new(object, "method", json_text(h->run->method));
  json_object_set_new(object, "status", json_text(h->run->status));
  json_object_set_new(object, "rows", json_integer((json_int_t)h->rows));
  json_object_set_new(object, "end_time_s", json_number(h->times[h->rows - 1]));
  json_object_set_new(object, "steady", json_boolean(s->is_steady));
  json_object_set_new(object, "steady_from_s", json_number(s->from_time));
  json_object_set_new(object, "darcy_velocity_m_per_s", json_number(s->mean));
  json_object_set_new(object, "darcy_velocity_error_m_per_s", json_number(s->error95));
  json_object_set_new(object, "drift_m_per_s", json_number(s->drift));
  json_object_set_new(object, "density_max_rise_percent",
                      json_number(100.0 * (h->density_peak - 1.0)));
  json_object_set_new(object, "density_mean_rise_percent",
                      json_number(100.0 * (h->density_mean - 1.0)));
  /* The series are thinned to what a plot can show; history.csv has every row. */
  json_object_set_new(object, "time_s", json_thinned(h->times, 1, h->rows));
  json_object_set_new(object, "darcy_velocity_series_m_per_s",
                      json_thinned(h->velocity, 1, h->rows));
  const struct history_column *density = run_column(h->run, "density_max", 1);
  json_object_set_new(object, "density_reference_kg_per_m3", json_number(h->run->density));
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
    if (is_standard(column->name) || column->rows == 0) continue;
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

/* One row per instant with every column, vectors as NAME_x, NAME_y, NAME_z. */
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
  fprintf(stream, "  %-26s %10s %12s %14s %9s %12s %10s\n", "run", "end (s)", "steady from",
          "v (m/s)", "+- 95 %", "max density", "status");
  for (size_t i = 0; i < n; i++) {
    const struct run_history *h = &table[i];
    char from[32] = "not steady", density[32] = "-", error[32] = "unknown";
    if (h->steady.is_steady) snprintf(from, sizeof from, "%.4g s", h->steady.from_time);
    if (isfinite(h->density_peak))
      snprintf(density, sizeof density, "%+.2f %%", 100.0 * (h->density_peak - 1.0));
    if (isfinite(h->steady.error95))
      snprintf(error, sizeof error, "%.2f %%", 100.0 * h->steady.error95 / fabs(h->steady.mean));
    fprintf(stream, "  %-26.60s %10.4g %12s %14.6g %9s %12s %10s\n", h->run->name,
            h->times[h->rows - 1], from, h->steady.mean, error, density, h->run->status);
  }
}

static void start_panel(FILE *stream, const char *xlabel, const char *ylabel) {
  fputs("set xlabel ", stream);
  plot_text(stream, xlabel);
  fputs(" noenhanced\nset ylabel ", stream);
  plot_text(stream, ylabel);
  fputs(" noenhanced\nplot ", stream);
}

/* `scale` * column, against ms when the runs are short. */
static void write_series(FILE *stream, const char *name, size_t i, size_t rows, const double *times,
                         double time_scale, const double *values, size_t stride, double scale,
                         double offset) {
  fprintf(stream, "$%s%zu << EOD\n", name, i);
  size_t step = rows / 1000 + 1; /* more points than pixels only swell the file */
  for (size_t r = 0; r < rows; r += step)
    if (isfinite(values[r * stride]))
      fprintf(stream, "%.8g %.8g\n", times[r] * time_scale, values[r * stride] * scale - offset);
  fputs("EOD\n", stream);
}

static void plot_lines(FILE *stream, const char *block, size_t n, const char *style,
                       const struct run_history *table) {
  for (size_t i = 0; i < n; i++) {
    fprintf(stream, "%s$%s%zu with %s linewidth 1.8 ", i > 0 ? ", " : "", block, i, style);
    plot_line_style(stream, i);
    fputs(" title ", stream);
    plot_text(stream, table[i].run->name);
  }
  fputs("\nunset key\n", stream);
}

static void plot_extra(FILE *stream, const struct run_history *table, size_t n, double time_scale,
                       const char *time_label, size_t column_of_first) {
  const struct history_column *model = &table[0].run->columns[column_of_first];
  size_t components = (size_t)model->components;
  for (size_t i = 0; i < n; i++) {
    const struct history_column *column = run_column(table[i].run, model->name, model->components);
    for (size_t d = 0; d < components && column != NULL; d++) {
      char block[32];
      snprintf(block, sizeof block, "c%zu_%zu_", column_of_first, d);
      write_series(stream, block, i, table[i].rows, table[i].times, time_scale, column->values + d,
                   components, 1.0, 0.0);
    }
  }
  char label[400];
  snprintf(label, sizeof label, "%s (%s)", model->name, model->unit[0] ? model->unit : "-");
  start_panel(stream, time_label, label);
  bool first = true;
  for (size_t i = 0; i < n; i++) {
    if (run_column(table[i].run, model->name, model->components) == NULL) continue;
    for (size_t d = 0; d < components; d++) {
      fprintf(stream, "%s$c%zu_%zu_%zu with lines linewidth 1.8 dashtype %zu ", first ? "" : ", ",
              column_of_first, d, i, d + 1);
      fprintf(stream, "linecolor rgb '%s'", plot_colours[i % PLOT_COLOURS]);
      first = false;
    }
  }
  fputc('\n', stream);
}

static void write_plot(const struct run_history *table, size_t n, struct product *product) {
  FILE *stream = product->plot.stream;
  size_t panels = 1, extras = 0;
  double longest = 0.0;
  bool any_density = false, any_peak = false;
  for (size_t i = 0; i < n; i++) {
    longest = fmax(longest, table[i].times[table[i].rows - 1]);
    any_density = any_density || table[i].density.bins > 0;
    any_peak = any_peak || isfinite(table[i].density_peak);
  }
  for (size_t c = 0; c < table[0].run->column_count; c++)
    extras += !is_standard(table[0].run->columns[c].name);
  panels += (size_t)any_density + (size_t)any_peak + extras;
  size_t across = panels > 1 ? 2 : 1, down = (panels + across - 1) / across;
  double time_scale = longest < 0.1 ? 1e3 : 1.0;
  const char *time_label = longest < 0.1 ? "Time (ms)" : "Time (s)";

  for (size_t i = 0; i < n; i++) {
    const struct run_history *h = &table[i];
    const struct history_column *peak = run_column(h->run, "density_max", 1);
    write_series(stream, "v", i, h->rows, h->times, time_scale, h->velocity, 1, 100.0, 0.0);
    if (peak != NULL)
      write_series(stream, "p", i, h->rows, h->times, time_scale, peak->values, 1,
                   100.0 / h->run->density, 100.0);
    if (h->density.bins == 0) continue;
    char name[32];
    snprintf(name, sizeof name, "d%zu", i);
    plot_steps(stream, name, h->density.bins, h->density.edges, h->density.density, 100.0, 100.0);
  }
  size_t key_rows = (n + 2) / 3;
  product->width = across == 2 ? 1200 : 800;
  product->height = (int)(down * 400 + key_rows * 26 + 20);
  double bottom = (double)(key_rows * 26 + 70) / product->height;
  fprintf(stream,
          "set multiplot layout %zu,%zu margins %s,0.985,%.4f,0.975 spacing 0.10,%.3f\n"
          "set key at screen 0.5,0.008 center bottom horizontal maxcols 3 samplen 2 reverse Left\n"
          "set yrange [*:*]\n",
          down, across, across == 2 ? "0.075" : "0.11", bottom, 85.0 / product->height);
  start_panel(stream, time_label, "Darcy velocity (cm/s)");
  plot_lines(stream, "v", n, "lines", table);
  if (any_peak) {
    start_panel(stream, time_label, "Maximum density above reference (%)");
    plot_lines(stream, "p", n, "lines", table);
  }
  if (any_density) {
    fputs("set yrange [0:*]\n", stream);
    start_panel(stream, "Density above reference, last snapshot (%)", "Probability density (1/%)");
    for (size_t i = 0, drawn = 0; i < n; i++) {
      if (table[i].density.bins == 0) continue;
      fprintf(stream, "%s$d%zu with lines linewidth 1.8 ", drawn++ > 0 ? ", " : "", i);
      plot_line_style(stream, i);
    }
    fputs("\nset yrange [*:*]\n", stream);
  }
  for (size_t c = 0; c < table[0].run->column_count; c++)
    if (!is_standard(table[0].run->columns[c].name))
      plot_extra(stream, table, n, time_scale, time_label, c);
  fputs("unset multiplot\n", stream);
}

enum status history_analyze(const struct run *runs, size_t n, struct product *product) {
  enum status status = STATUS_OK;
  struct run_history *table = NULL;
  TRY(memory_allocate(&table, n, sizeof *table, "runs"));
  json_t *list = json_array();
  json_object_set_new(product->json, "runs", list);
  for (size_t i = 0; i < n; i++) {
    TRY(measure(&runs[i], &table[i]));
    json_t *object = json_object();
    fill_json(&table[i], object);
    json_array_append_new(list, object);
  }
  if (n == 1) fill_json(&table[0], product->json);
  write_csv(runs, n, product->csv.stream);
  write_summary(table, n, product->summary.stream);
  write_plot(table, n, product);
cleanup:
  for (size_t i = 0; table != NULL && i < n; i++) {
    memory_free(&table[i].times);
    memory_free(&table[i].velocity);
    pdf_free(&table[i].density);
  }
  memory_free(&table);
  return status;
}
