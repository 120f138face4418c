/* How near particles are to the surface. */
#ifndef TOSUI_SPHSOLVE_ISPH_NEAR_SURFACE_H
#define TOSUI_SPHSOLVE_ISPH_NEAR_SURFACE_H

#include "sphsolve/isph/state.h"

/* Largest `surface` of each own particle and its neighbours, near [count]. */
void isph_find_near_surface(const struct isph *s, double *near);
/* The same of particle i (1: on the surface or with a neighbour on it), and the outward normal of
 * the surface there. */
double isph_near_surface(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                         double normal[3]);

#endif
