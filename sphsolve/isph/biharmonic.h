/* Biharmonic viscosity of calm free water (isph/calm.h),
 *   dv/dt = ... - nu_4 L (calm L v),   nu_4 = 0.7125 r0^2 nu_c,
 * with L the pairwise Laplacian of M15, eq. 22. As in the scheme of Jameson, Schmidt, Turkel (1981,
 * AIAA 81-1259) the dissipation is of fourth order where the flow is smooth and of second order
 * elsewhere. L is symmetric, so that the force takes energy from any velocity field. A velocity
 * that alternates from particle to particle is damped as much as by twice nu_c, the artificial
 * viscosity (effects/artificial_viscosity.h); a wave on 16 rows of particles only a fiftieth as
 * much as by nu_c. Explicit: stable up to a dt of 2 sqrt(r0/|f|), eight times the limit of the
 * driving force. */
#ifndef TOSUI_SPHSOLVE_ISPH_BIHARMONIC_H
#define TOSUI_SPHSOLVE_ISPH_BIHARMONIC_H

#include "sphsolve/isph/state.h"

/* Sets s->curvature = calm L v of all particles, with the velocities at the beginning of the step.
 */
void isph_biharmonic_begin(struct isph *s);
/* Sets s->biharmonic[i] = - nu_4 L (calm L v) of particle i and adds it to `force`, m/s^2. */
void isph_biharmonic(struct isph *s, const struct isph_chunk *chunk, size_t i, double force[3]);

#endif
