#include "analyze/chart.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "analyze/plot.h"
#include "common/json_number.h"

static const char *text_of(const json_t *object, const char *key) {
  const char *text = json_string_value(json_object_get(object, key));
  return text != NULL ? text : "";
}

json_t *chart_add(json_t *charts, const char *title, const char *x, const char *y,
                  enum chart_axes axes, enum chart_place place) {
  static const char *const AXES[] = {"plain", "zero", "log x", "log y", "log xy"};
  static const char *const PLACES[] = {"open", "folded", "files"};
  json_t *chart =
      json_pack("{s:o,s:o,s:o,s:s,s:s,s:[]}", "title", json_text(title), "x", json_text(x), "y",
                json_text(y), "axes", AXES[axes], "place", PLACES[place], "series");
  json_array_append_new(charts, chart);
  return chart;
}

json_t *chart_find(const json_t *charts, const char *title) {
  json_t *chart;
  size_t c;
  json_array_foreach(charts, c, chart) {
    if (strcmp(text_of(chart, "title"), title) == 0) return chart;
  }
  return NULL;
}

json_t *chart_series(json_t *chart, const char *name, enum chart_style style, int colour,
                     int dash) {
  json_t *series = json_pack("{s:o,s:[],s:b,s:i,s:i}", "name", json_text(name), "points", "dots",
                             style == CHART_DOTS, "colour", colour, "dash", dash);
  json_array_append_new(json_object_get(chart, "series"), series);
  return series;
}

void chart_point(json_t *series, double x, double y) {
  json_array_append_new(json_object_get(series, "points"),
                        json_pack("[o,o]", json_number(x), json_number(y)));
}

void chart_interval(json_t *series, double x, double y, double low, double high) {
  json_array_append_new(
      json_object_get(series, "points"),
      json_pack("[o,o,o,o]", json_number(x), json_number(y), json_number(low), json_number(high)));
}

void chart_steps(json_t *series, size_t bins, const double *edges, const double *heights,
                 double scale, double offset) {
  for (size_t i = 0; i < bins; i++) {
    const double low = scale * edges[i] - offset, high = scale * edges[i + 1] - offset;
    if (heights[i] > 0.0) {
      chart_point(series, low, heights[i] / scale);
      chart_point(series, high, heights[i] / scale);
    } else if (i > 0 && heights[i - 1] > 0.0)
      chart_point(series, low, NAN);
  }
}

/* Whether a point of a series can be drawn. */
static bool has_points(const json_t *series) {
  const json_t *point;
  size_t i;
  json_array_foreach(json_object_get(series, "points"), i, point) {
    if (json_is_number(json_array_get(point, 1))) return true;
  }
  return false;
}

void chart_drop_empty(json_t *charts) {
  for (size_t c = json_array_size(charts); c-- > 0;) {
    json_t *list = json_object_get(json_array_get(charts, c), "series");
    for (size_t s = json_array_size(list); s-- > 0;)
      if (!has_points(json_array_get(list, s))) json_array_remove(list, s);
    if (json_array_size(list) == 0) json_array_remove(charts, c);
  }
}

static int integer_of(const json_t *object, const char *key) {
  return (int)json_integer_value(json_object_get(object, key));
}

/* $chart_series: x y low high; an empty line for a gap. */
static void write_block(const json_t *series, size_t c, size_t s, FILE *stream) {
  const json_t *point, *value;
  size_t i, k;
  fprintf(stream, "$c%zu_%zu << EOD\n", c, s);
  json_array_foreach(json_object_get(series, "points"), i, point) {
    if (json_is_number(json_array_get(point, 1))) json_array_foreach(point, k, value) {
        if (json_is_number(value))
          fprintf(stream, "%s%.8g", k > 0 ? " " : "", json_number_value(value));
        else
          fputs(" NaN", stream);
      }
    fputc('\n', stream);
  }
  fputs("EOD\n", stream);
}

static void write_series(const json_t *series, size_t c, size_t s, FILE *stream) {
  const bool dots = json_is_true(json_object_get(series, "dots"));
  const int colour = integer_of(series, "colour"), dash = integer_of(series, "dash");
  const bool interval = json_array_size(json_array_get(json_object_get(series, "points"), 0)) == 4;
  fprintf(stream, "%s$c%zu_%zu using 1:2%s with %s linewidth 1.8 ", s > 0 ? ", \\\n  " : "plot ", c,
          s, interval ? ":3:4" : "",
          interval ? "yerrorbars"
          : dots   ? "points"
                   : "lines");
  if (colour == CHART_GREY)
    fprintf(stream, "linecolor rgb '#777777' dashtype %d", 1 + dash);
  else if (dash > 0)
    fprintf(stream, "linecolor rgb '%s' dashtype %d", plot_colours[colour % PLOT_COLOURS],
            1 + dash);
  else
    plot_line_style(stream, (size_t)colour);
  if (dots) plot_point_style(stream, colour < 0 ? 0 : (size_t)colour);
  fputs(" title ", stream);
  plot_text(stream, text_of(series, "name"));
}

/* A panel with its key below it. */
static void write_chart(const json_t *chart, size_t c, FILE *stream) {
  const json_t *series = json_object_get(chart, "series"), *one;
  const char *axes = text_of(chart, "axes");
  size_t s;
  json_array_foreach(series, s, one) write_block(one, c, s, stream);
  fputs("unset logscale\nset format '%.4g'\nset autoscale\n", stream);
  if (strncmp(axes, "log ", 4) == 0)
    fprintf(stream, "set logscale %s\nset format %s '10^{%%L}'\n", axes + 4, axes + 4);
  if (strcmp(axes, "zero") == 0) fputs("set yrange [*<0:0<*]\n", stream);
  fputs("set title ", stream);
  plot_text(stream, text_of(chart, "title"));
  fputs(" noenhanced\nset xlabel ", stream);
  plot_text(stream, text_of(chart, "x"));
  fputs(" noenhanced\nset ylabel ", stream);
  plot_text(stream, text_of(chart, "y"));
  fputs(" noenhanced\n", stream);
  json_array_foreach(series, s, one) write_series(one, c, s, stream);
  fputc('\n', stream);
}

void chart_script(const json_t *charts, const char *picture, FILE *stream, int *width,
                  int *height) {
  enum { ACROSS = 640, UP = 460, KEY = 24 /* a row of it */ };
  const json_t *chart;
  size_t c, rows = 0;
  const size_t panels = json_array_size(charts) + (*picture != '\0');
  const size_t across = panels > 1 ? 2 : 1, down = (panels + across - 1) / across;
  json_array_foreach(charts, c, chart) {
    const size_t names = (json_array_size(json_object_get(chart, "series")) + 1) / 2;
    rows = names > rows ? names : rows;
  }
  *width = panels > 1 ? 2 * ACROSS : 800;
  *height = (int)(down * (UP + rows * KEY));
  fprintf(stream, "set multiplot layout %zu,%zu\n", down, across);
  fputs(picture, stream);
  if (*picture != '\0')
    fputs("set size noratio\nset xtics autofreq\nunset colorbox\nunset xrange\n", stream);
  fputs("set key below center vertical maxcols 2 samplen 2 reverse Left\n", stream);
  json_array_foreach(charts, c, chart) write_chart(chart, c, stream);
  fputs("unset multiplot\n", stream);
}
