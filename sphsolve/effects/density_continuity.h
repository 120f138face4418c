/* Pressure of a weakly compressible fluid from the divergence of the velocity.
 *   dp_i/dt = - rho_0 c^2 div v_i,   div v_i = sum_j V (v_j - v_i) . grad_i W,
 * a wall particle moving with 2 v_wall - v_i, which makes it the transpose of the pressure gradient
 * of pressure_difference.h; beside adami's walls, whose pressure is their own, with v_wall. (Monaghan 1994, eq. 2.4, with the volume of a particle kept; the sum of
 * densities would instead store the bumps of the particle lattice as pressure.) */
#ifndef TOSUI_EFFECT_DENSITY_CONTINUITY_H
#define TOSUI_EFFECT_DENSITY_CONTINUITY_H

#include "sphsolve/engine/simd.h"

SIMD_INLINE void density_continuity_pair(vec slope, vec x, vec y, vec z, vec dvx, vec dvy, vec dvz,
                                         vec *sum) {
  *sum += slope * (x * dvx + y * dvy + z * dvz);
}

#endif
