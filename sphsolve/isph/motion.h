/* Displacement of the particles in a step: advection with the water, and shifting. */
#ifndef TOSUI_SPHSOLVE_ISPH_MOTION_H
#define TOSUI_SPHSOLVE_ISPH_MOTION_H

#include "sphsolve/isph/state.h"

/* After the correction: moves the particles by dx/dt = v/eps and the shift, limited
 * at walls. v is the mean of the old and the new velocity (Cummins, Rudman 1999, eq. 24) if there
 * can be no waves on a surface; otherwise the new one, as the mean would be an explicit scheme for
 * waves and amplify them. */
void isph_move(struct isph *s, double dt);

#endif
