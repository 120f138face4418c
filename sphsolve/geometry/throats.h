/* Throats that a lattice of other sites than the model's voxels closes or opens. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_THROATS_H
#define TOSUI_SPHSOLVE_GEOMETRY_THROATS_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* closed: so many pieces more there are in `coarse` of pores that hang together in `fine` (pieces
 * of a single site, as walls leave them, are not counted); opened: so many pores of `fine` have
 * become one with another. A throat beside which another leads to the same place is not seen. */
struct throats {
  size_t closed, opened;
};

/* Two lattices of one periodic body with the same axes; where `coarse` holds the body several
 * times, nothing is counted. */
enum status throats_compare(const struct lattice *fine, const struct lattice *coarse,
                            struct throats *throats);

#endif
