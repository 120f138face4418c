/* Charts of an analysis, described once: the report draws them (common/page_charts.js), and `-o`
 * as SVG and PNG (gnuplot).
 * A chart is {"title", "x", "y": labels with units, "axes": "plain", "zero" (y shows 0), "log x",
 * "log y" or "log xy", "place": "open", "folded" or "files", "series": [{"name", "points": [[x, y],
 * or [x, y, low, high]; y null: a gap], "dots": points instead of a line, "colour", "dash"}]}. */
#ifndef TOSUI_ANALYZE_CHART_H
#define TOSUI_ANALYZE_CHART_H

#include <jansson.h>
#include <stddef.h>
#include <stdio.h>

/* Where the page shows a chart: openly, behind a fold, or not at all, but for the files of `-o`. */
enum chart_place { CHART_OPEN, CHART_FOLDED, CHART_OF_FILES };
enum chart_axes { CHART_PLAIN, CHART_ZERO, CHART_LOG_X, CHART_LOG_Y, CHART_LOG_XY };
enum chart_style { CHART_LINE, CHART_DOTS };
#define CHART_GREY (-1) /* instead of a colour */

/* Adds an empty chart to the array `charts`, and a series without points to a chart; both belong to
 * what they were added to. */
json_t *chart_add(json_t *charts, const char *title, const char *x, const char *y,
                  enum chart_axes axes, enum chart_place place);
json_t *chart_series(json_t *chart, const char *name, enum chart_style style, int colour, int dash);
/* The chart of that title; NULL without one. */
json_t *chart_find(const json_t *charts, const char *title);
/* Adds a point; y NAN: a gap in the line. Low and high are its interval. */
void chart_point(json_t *series, double x, double y);
void chart_interval(json_t *series, double x, double y, double low, double high);
/* Adds a histogram as steps; an empty bin is a gap. x = scale * edge - offset, y = height / scale.
 */
void chart_steps(json_t *series, size_t bins, const double *edges, const double *heights,
                 double scale, double offset);
/* Removes charts in which nothing can be drawn. */
void chart_drop_empty(json_t *charts);

/* Writes a gnuplot script of the charts side by side, behind `picture`, a script of the first panel
 * ("": none), and sets the size of all in pixels. */
void chart_script(const json_t *charts, const char *picture, FILE *stream, int *width, int *height);

#endif
