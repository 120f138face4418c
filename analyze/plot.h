/* Plots by gnuplot, run as a program on a script that is kept: NAME.gp contains the data and the
 * style, so that a user can change it and run `gnuplot NAME.gp` again. */
#ifndef TOSUI_ANALYZE_PLOT_H
#define TOSUI_ANALYZE_PLOT_H

#include <stddef.h>
#include <stdio.h>

#include "common/error.h"

/* Okabe, Ito (2008): eight colours that colour-blind people can distinguish; black is the last. */
#define PLOT_COLOURS 8
extern const char *const plot_colours[PLOT_COLOURS];
/* Writes "linecolor rgb '#..' dashtype .." for series i; and " pointtype ..", for styles with
 * points. */
void plot_line_style(FILE *stream, size_t i);
void plot_point_style(FILE *stream, size_t i);

/* Writes `text` as a gnuplot string, in double quotes: a text in single ones cannot begin with an
 * apostrophe. Use with `noenhanced`. */
void plot_text(FILE *stream, const char *text);

/* Writes FOLDER/NAME.gp (head + body) and runs it to make NAME.svg and NAME.png. Without gnuplot
 * there is a warning, but no failure. */
enum status plot_save(const char *folder, const char *name, const char *body, int width,
                      int height);

/* Runs gnuplot on head + body and returns the SVG in new memory (memory_free); NULL without
 * gnuplot. */
enum status plot_svg(const char *name, const char *body, int width, int height, char **svg);

#endif
