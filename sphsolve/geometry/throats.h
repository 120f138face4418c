/* Throats that are closed or opened when a model is resampled. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_THROATS_H
#define TOSUI_SPHSOLVE_GEOMETRY_THROATS_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* closed: number of additional pieces in `coarse` into which connected pores of `fine` fall (pieces
 * of a single site, as walls leave them, do not count); opened: number of pores of `fine` that
 * become connected to another one. A throat next to another one that connects the same pores is not
 * detected. */
struct throats {
  size_t closed, opened;
};

/* Compares two lattices of one periodic body with the same axes; if `coarse` contains several
 * copies of the body, both counts are 0. */
enum status throats_compare(const struct lattice *fine, const struct lattice *coarse,
                            struct throats *throats);

#endif
