/* The walls of a lattice as they would appear in a scan with additional blur. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_SURFACE_BLUR_H
#define TOSUI_SPHSOLVE_GEOMETRY_SURFACE_BLUR_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* `out` has the spacing of `level` and the wall surface that a threshold finds, at the same void
 * ratio, in the image of `fine` blurred by a Gaussian of standard deviation `deviation` (m): narrow
 * pores close, corners become round, wide pores grow. If `fine` is too coarse for that, a larger
 * blur is applied; a change proportional to the variance of the blur is then *scale times the one
 * found. Periodic. Free with lattice_free. */
enum status lattice_blur(const struct lattice *fine, double deviation, const struct lattice *level,
                         double *scale, struct lattice *out);

#endif
