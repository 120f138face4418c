/* The walls of a lattice as a scan would show them that is blurred once more. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_SURFACE_BLUR_H
#define TOSUI_SPHSOLVE_GEOMETRY_SURFACE_BLUR_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* `out` has sites as far apart as those of `level`, and the wall surface that a threshold finds in
 * the image of `fine` blurred by a Gaussian of standard deviation `deviation` (m), at the same void
 * ratio: narrow pores close, corners are cut, wide pores grow. Where `fine` is too coarse to hold
 * that, it is blurred by more: a change that goes with the blur's variance is then *scale times the
 * one found. Periodic. Free with lattice_free. */
enum status lattice_blur(const struct lattice *fine, double deviation, const struct lattice *level,
                         double *scale, struct lattice *out);

#endif
