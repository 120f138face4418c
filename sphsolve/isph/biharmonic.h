/* Biharmonic viscosity of calm free water (isph/calm.h),
 *   dv/dt = ... - nu_4 L (calm L v),   nu_4 = 0.7125 r0^2 nu_c,
 * L the Laplacian by pairs of M15, eq. 22: fourth differences where it is smooth and second ones
 * where it is not, as of Jameson, Schmidt, Turkel (1981, AIAA 81-1259). L is symmetric, so that the
 * force takes energy from any field. What differs from particle to particle loses as much as by
 * twice nu_c, the artificial viscosity (effects/artificial_viscosity.h), a wave on 16 rows a
 * fiftieth of what that takes. Explicit: stable up to a dt of 2 sqrt(r0/|f|), eight times that of
 * the driving force. */
#ifndef TOSUI_SPHSOLVE_ISPH_BIHARMONIC_H
#define TOSUI_SPHSOLVE_ISPH_BIHARMONIC_H

#include "sphsolve/isph/state.h"

/* s->curvature = calm L v of all particles, by the velocities of the step's beginning. */
void isph_biharmonic_begin(struct isph *s);
/* Adds s->biharmonic = - nu_4 L (calm L v) of particle i to `force`, m/s^2. */
void isph_biharmonic(struct isph *s, const struct isph_chunk *chunk, size_t i, double force[3]);

#endif
