/* The mobility of a pair of particles in the pressure equation. */
#ifndef TOSUI_SPHSOLVE_ISPH_MOBILITY_H
#define TOSUI_SPHSOLVE_ISPH_MOBILITY_H

#include <math.h>
#include "sphsolve/isph/state.h"

/* Mobility of pair p of particle i with j: that of its path if there are links; at a corner of
 * soils, where the mean is geometric, between that and the harmonic mean of the particles' own
 * (isph/interface.c). Water with a free surface keeps the plain mean and the gradient that is the
 * divergence's adjoint, because its energy may not rise. */
static inline double isph_mobility_between(const struct isph *s, const struct isph_chunk *chunk,
                                           size_t p, size_t i, size_t j) {
  const double a = s->mobility[i], b = s->mobility[j];
  if (s->on.mean_of_ends) return 0.5 * (a + b);
  if (s->on.own_mobilities) return 2 * a * b / (a + b);
  const double way = (double)chunk->mobility[p];
  const double plane = s->on.interfaces ? fmin(s->interface[i].plane, s->interface[j].plane) : 1;
  return plane < 1 ? pow(way, plane) * pow(2 * a * b / (a + b), 1 - plane) : way;
}

#endif
