/* Fronts of water in dry soil. Rows of particles that enter soil keep their spacing along the face
 * and are stretched normal to it by 1/eps. At eps = .3 a particle of the foremost row has so many
 * neighbours along its row, and those behind are so far away, that the asymmetry of its
 * neighbourhood (effects/surface.h) is a quarter of that at a level surface. By the asymmetry alone
 * it would count as within the water, no row would fix the pressure, and an ordered front would
 * stand still. The criterion for a front is that all neighbours in the normal direction are on one
 * side:
 *   o = |sum V grad W| / sum |V grad W.n|,   n along sum V grad W,
 * is 1 there, below .5 within disordered water, and .7 to .9 at disordered fronts, which the
 * asymmetry recognises. At rest any surface weight gives the same pressure. In motion the full
 * weight, with P = 0 half a particle ahead, is too near where rows stand 1/eps apart: fronts would
 * run up to a quarter early; with a tenth they follow the balance of a plug.
 *
 * A wall ahead is not water: what of it lies beyond the void is left out of all these sums, until
 * the void is closed, that is until |sum V grad W| with that wall is less than .4 to .2 of that
 * without it. Counted as neighbours, walls would take a front off the surface one row before they
 * are reached, and its last row would jump. */
#ifndef TOSUI_SPHSOLVE_ISPH_FRONT_H
#define TOSUI_SPHSOLVE_ISPH_FRONT_H

#include <math.h>

#include "sphsolve/isph/state.h"

#define FRONT_DEEP 0.75 /* soil fraction below which a particle is not deep in soil */

/* How far particle i is inside soil, away from its edges, 0 .. 1. */
static inline double isph_front_deep(const struct isph *s, size_t i) {
  return fmax(0, (s->soil_fraction[i] - FRONT_DEEP) / (1 - FRONT_DEEP));
}

/* Raises the surface weight of particle i in soil to that of a front, from its pairs, walls and
 * gradient sum. Walls beyond a void are taken out of the gradient sum and of `moment`, the second
 * moment of all its neighbours (xx xy xz yy yz zz). Returns the degree, 0 .. 1, to which its
 * neighbours in the normal direction are on one side only. */
double isph_front_find(struct isph *s, const struct isph_chunk *chunk, size_t i, double moment[6]);

#endif
