#include "analyze/history_plot.h"

#include <math.h>
#include <string.h>

#include "analyze/plot.h"

/* Columns of every run; all others were added by the scene (gauges, planes, volumes). */
bool history_is_standard(const char *column) {
  static const char *const names[] = {
      "time",         "step",     "dt",   "darcy_velocity", "density_max",
      "density_mean", "momentum", "mass", "kinetic_energy", "reynolds"};
  for (size_t i = 0; i < sizeof names / sizeof *names; i++)
    if (strcmp(column, names[i]) == 0) return true;
  return false;
}

static void start_panel(FILE *stream, const char *xlabel, const char *ylabel) {
  fputs("set xlabel ", stream);
  plot_text(stream, xlabel);
  fputs(" noenhanced\nset ylabel ", stream);
  plot_text(stream, ylabel);
  fputs(" noenhanced\nplot ", stream);
}

/* Writes `scale` times a column, against ms if the runs are short. */
static void write_series(FILE *stream, const char *name, size_t i, size_t rows, const double *times,
                         double time_scale, const double *values, size_t stride, double scale,
                         double offset) {
  fprintf(stream, "$%s%zu << EOD\n", name, i);
  size_t step = rows / 1000 + 1; /* more points than pixels only enlarge the file */
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

/* Whether a component has values to plot: not y in two dimensions, and not only NAN, as a level
 * without water. */
static bool has_values(const struct run *run, const struct history_column *column, size_t d) {
  if (column == NULL || (column->components > 1 && d == 1 && run->dimensions == 2)) return false;
  for (size_t r = 0; r < column->rows; r++)
    if (isfinite(column->values[r * (size_t)column->components + d])) return true;
  return false;
}

/* Whether a column has its own panel: those added by scenes and methods. The works of the energy
 * budget are shown as a table (/run/ledger), as twenty panels would hide the gauges. */
static bool has_panel(const struct run_history *table, size_t n, size_t column_of_first) {
  const struct history_column *model = &table[0].run->columns[column_of_first];
  if (history_is_standard(model->name) || strncmp(model->name, "work_", 5) == 0) return false;
  for (size_t i = 0; i < n; i++)
    for (size_t d = 0; d < (size_t)model->components; d++)
      if (has_values(table[i].run, run_column(table[i].run, model->name, model->components), d))
        return true;
  return false;
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
  snprintf(label, sizeof label, "%s (%s)", model->name,
           strcmp(model->unit, "1") == 0 || model->unit[0] == '\0' ? "-" : model->unit);
  for (char *at = label; *at != '\0' && *at != '('; at++)
    if (*at == '_') *at = ' ';
  fputs(spans_decades(model) ? "set logscale y\nset format y '10^{%L}'\n" : "set format y '%.4g'\n",
        stream);
  start_panel(stream, time_label, label);
  bool first = true;
  for (size_t i = 0; i < n; i++) {
    const struct history_column *column = run_column(table[i].run, model->name, model->components);
    for (size_t d = 0; d < components; d++) {
      if (!has_values(table[i].run, column, d)) continue;
      fprintf(stream, "%s$c%zu_%zu_%zu with lines linewidth 1.8 dashtype %zu ", first ? "" : ", ",
              column_of_first, d, i, d + 1);
      fprintf(stream, "linecolor rgb '%s'", plot_colours[i % PLOT_COLOURS]);
      first = false;
    }
  }
  fputs("\nunset logscale y\nset format y\n", stream);
}

void history_plot(const struct run_history *table, size_t n, struct product *product) {
  FILE *stream = product->plot.stream;
  size_t panels = 1, extras = 0;
  double longest = 0.0;
  bool any_density = false, any_peak = false;
  for (size_t i = 0; i < n; i++) {
    longest = fmax(longest, table[i].times[table[i].rows - 1]);
    any_density = any_density || table[i].density.bins > 0;
    any_peak = any_peak || fabs(table[i].density_peak - 1.0) > 1e-9; /* false for NAN */
  }
  for (size_t c = 0; c < table[0].run->column_count; c++) extras += has_panel(table, n, c);
  panels += (size_t)any_density + (size_t)any_peak + extras;
  size_t across = panels > 1 ? 2 : 1, down = (panels + across - 1) / across;
  bool iterations = table[0].stationary;
  double time_scale = longest < 0.1 && !iterations ? 1e3 : 1.0;
  const char *time_label = iterations ? "Iteration" : longest < 0.1 ? "Time (ms)" : "Time (s)";

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
          "set multiplot layout %zu,%zu margins %s,0.985,%.4f,0.975 spacing 0.115,%.3f\n"
          "set key at screen 0.5,0.008 center bottom horizontal maxcols 3 samplen 2 reverse Left\n"
          "set yrange [*:*]\nset autoscale xfix\n",
          down, across, across == 2 ? "0.09" : "0.12", bottom, 85.0 / product->height);
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
    if (has_panel(table, n, c)) plot_extra(stream, table, n, time_scale, time_label, c);
  fputs("unset multiplot\n", stream);
}
