/* Convergence of k and its error bar from lattice to lattice, drawn on a terminal during a
 * cascade. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_LEVEL_BAR_H
#define TOSUI_SPHSOLVE_OUTPUT_LEVEL_BAR_H

#include <stddef.h>

#include "sphsolve/output/uncertainty.h"

/* Draws the estimate of the last lattice and its error bar, relative to k of the first lattice:
 * "0.97 s | --o-- | 0.0299 cm/s"; the seconds are those of all lattices so far. `to_speed`: factor
 * from m^2 to m/s; `columns`: width of the bar, 56 at most. */
void level_bar_draw(const struct uncertainty *uncertainty, double to_speed, int columns, char *text,
                    size_t size);
/* The same on stderr, if that is a terminal, with the width of the terminal. */
void level_bar_show(const struct uncertainty *uncertainty, double to_speed);

#endif
