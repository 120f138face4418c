/* Fronts in soil. Rows of water that enter soil keep their spacing along the face and are drawn out
 * across it by 1/eps: at eps = .3 a particle of the foremost row has so many neighbours along it,
 * and those behind are so far, that its neighbourhood's asymmetry (effects/surface.h) is a quarter
 * of a level surface's. It counted as within the water, no row fixed the pressure, and a front that
 * nothing disorders stood still. What tells it is that all neighbours across stand on one side:
 *   o = |sum V grad W| / sum |V grad W.n|,   n along sum V grad W,
 * is 1 there, below .5 within disordered water, .7 to .9 at fronts in disorder, which the asymmetry
 * knows. At rest any weight of the surface gives the same pressure. In motion the whole of it, half
 * a particle ahead, is too near where rows stand 1/eps apart: fronts ran up to a quarter early;
 * with a tenth they keep to a plug's balance.
 *
 * A wall ahead is no water: what of it lies beyond the void is left out of all these sums, until
 * the void is shut, |sum V grad W| with that wall less than .4 to .2 of that without. Counted as
 * neighbours walls took a front from the surface a row ahead of them, and its last row leapt. */
#ifndef TOSUI_SPHSOLVE_ISPH_FRONT_H
#define TOSUI_SPHSOLVE_ISPH_FRONT_H

#include <math.h>

#include "sphsolve/isph/state.h"

#define FRONT_DEEP 0.75 /* of the share of soil: below, a particle is not deep in it */

/* How far particle i is deep in soil, 0 .. 1. */
static inline double isph_front_deep(const struct isph *s, size_t i) {
  return fmax(0, (s->soil_fraction[i] - FRONT_DEEP) / (1 - FRONT_DEEP));
}

/* Raises how far particle i in soil is on a surface to what that says, from its pairs, walls and
 * gradient sum; walls beyond a void are taken out of the gradient sum and of `moment`, the second
 * moment of all its neighbours (xx xy xz yy yz zz). Returns how far, 0 .. 1, its neighbours across
 * stand on one side. */
double isph_front_find(struct isph *s, const struct isph_chunk *chunk, size_t i, double moment[6]);

#endif
