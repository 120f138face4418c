/* Plots by gnuplot, which runs as a program on a kept script: NAME.gp holds the data and the style,
 * so that a user can change it and run `gnuplot NAME.gp` again. */
#ifndef TOSUI_ANALYZE_PLOT_H
#define TOSUI_ANALYZE_PLOT_H

#include <stddef.h>
#include <stdio.h>

#include "common/error.h"

/* Okabe, Ito (2008): eight colours that colour-blind people can tell apart; black comes last. */
#define PLOT_COLOURS 8
extern const char *const plot_colours[PLOT_COLOURS];
/* "linecolor rgb '#..' dashtype .." of series i; and " pointtype ..", for styles that have points.
 */
void plot_line_style(FILE *stream, size_t i);
void plot_point_style(FILE *stream, size_t i);

/* `text` as a gnuplot string in single quotes; nothing in it is interpreted. Use with
 * `noenhanced`. */
void plot_text(FILE *stream, const char *text);

/* `$name << EOD` with a histogram as a line of steps; empty bins are gaps, so that it can stand on
 * a logarithmic axis. x = scale * edge - offset, y = height / scale. */
void plot_steps(FILE *stream, const char *name, size_t bins, const double *edges,
                const double *heights, double scale, double offset);

/* Writes FOLDER/NAME.gp (head + body) and runs it for NAME.svg and NAME.png. Without gnuplot: one
 * warning, no failure. */
enum status plot_save(const char *folder, const char *name, const char *body, int width,
                      int height);

/* Runs gnuplot on head + body and gives the SVG in new memory (memory_free); NULL without gnuplot.
 */
enum status plot_svg(const char *name, const char *body, int width, int height, char **svg);

#endif
