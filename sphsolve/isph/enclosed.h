/* Bodies of water that fill the room they are in. */
#ifndef TOSUI_SPHSOLVE_ISPH_ENCLOSED_H
#define TOSUI_SPHSOLVE_ISPH_ENCLOSED_H

#include "sphsolve/isph/state.h"

/* All collective: finds bodies of water without a surface, in scenes with one.
 * After the neighbour search, before `surface` is sent. */
enum status isph_find_enclosed(struct isph *s);
/* Subtracts the mean of the source of their rows, which no pressure could satisfy. */
void isph_enclosed_source(struct isph *s, double *source);
/* Sets the constant of their pressure. */
void isph_enclosed_level(struct isph *s);

#endif
