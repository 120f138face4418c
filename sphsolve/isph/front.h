/* Fronts in soil. Rows of water that enter soil keep their spacing along the face and are drawn out
 * across it by 1/eps: at eps = .3 a particle of the foremost row has so many neighbours along it,
 * and those behind are so far, that its neighbourhood's asymmetry (effects/surface.h) is a quarter
 * of a level surface's. It counted as within the water, no row fixed the pressure, and a front that
 * nothing disorders stood still. What tells it is that all neighbours across stand on one side:
 *   o = |sum V grad W| / sum |V grad W.n|,   n along sum V grad W,
 * is 1 there, below .5 within disordered water, .7 to .9 at fronts in disorder, which the asymmetry
 * knows. At rest any weight of the surface gives the same pressure. In motion the whole of it, half
 * a particle ahead, is too near where rows stand 1/eps apart: fronts ran up to a quarter early;
 * with a tenth they keep to a plug's balance. */
#ifndef TOSUI_SPHSOLVE_ISPH_FRONT_H
#define TOSUI_SPHSOLVE_ISPH_FRONT_H

#include "sphsolve/isph/state.h"

/* Raises how far particle i in soil is on a surface to what that says; from its pairs, walls and
 * gradient sum. */
void isph_front_find(struct isph *s, const struct isph_chunk *chunk, size_t i);

#endif
