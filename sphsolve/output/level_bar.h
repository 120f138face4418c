/* How k and its bar close in, lattice by lattice, drawn on a terminal while a cascade runs. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_LEVEL_BAR_H
#define TOSUI_SPHSOLVE_OUTPUT_LEVEL_BAR_H

#include <stddef.h>

#include "sphsolve/output/uncertainty.h"

/* The last lattice's estimate and its bar, on the scale of the first lattice: "0.97 s |   --o--  |
 * 0.0299 cm/s"; the seconds are those of all lattices so far. `to_speed`: from m^2 to
 * m/s; `columns`: of the bar, 56 at most. */
void level_bar_draw(const struct uncertainty *uncertainty, double to_speed, int columns, char *text,
                    size_t size);
/* The same on stderr, if that is a terminal, as wide as that has room for. */
void level_bar_show(const struct uncertainty *uncertainty, double to_speed);

#endif
