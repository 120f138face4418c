/* The walls of a lattice as a scan would show them that is blurred once more. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_SURFACE_BLUR_H
#define TOSUI_SPHSOLVE_GEOMETRY_SURFACE_BLUR_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* `out` has the sites of `in` and the wall surface that a threshold finds in its image blurred by a
 * Gaussian of standard deviation `deviation` (m; at least about a spacing) at the same void ratio:
 * narrow pores close, corners are cut, wide pores grow. Periodic. Free with lattice_free. */
enum status lattice_blur(const struct lattice *in, double deviation, struct lattice *out);

/* The walls of `fine` blurred so, on sites as far apart as those of `level`. Where `fine` is too
 * coarse to hold that, they are blurred by more: a change that goes with the blur's variance is
 * then *scale times the one found. */
enum status lattice_blur_level(const struct lattice *fine, double deviation,
                               const struct lattice *level, double *scale, struct lattice *out);

#endif
