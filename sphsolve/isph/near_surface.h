/* How near particles are to the surface. */
#ifndef TOSUI_SPHSOLVE_ISPH_NEAR_SURFACE_H
#define TOSUI_SPHSOLVE_ISPH_NEAR_SURFACE_H

#include "sphsolve/isph/state.h"

/* Sets `to` to the largest value of `from` in each own particle's neighbourhood. */
void isph_neighbourhood_maximum(const struct isph *s, const double *from, double *to);
/* The largest `surface` around particle i (1: on the surface or with a neighbour on it), and the
 * outward normal of the surface there. */
double isph_near_surface(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                         double normal[3]);

#endif
