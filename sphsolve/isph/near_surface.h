/* How near particles are to the surface. */
#ifndef TOSUI_SPHSOLVE_ISPH_NEAR_SURFACE_H
#define TOSUI_SPHSOLVE_ISPH_NEAR_SURFACE_H

#include "sphsolve/isph/state.h"

/* Sets `to` to the largest value of `from` in each own particle's neighbourhood. */
void isph_neighbourhood_maximum(const struct isph *s, const double *from, double *to);
/* The outward normal of the surface near particle i. */
void isph_surface_normal(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                         double normal[3]);

#endif
