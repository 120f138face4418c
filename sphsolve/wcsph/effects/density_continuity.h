/* Pressure of a weakly compressible fluid from the divergence of the velocity.
 *   dp_i/dt = - rho_0 c^2 div v_i,   div v_i = sum_j V (v_j - v_i) . grad_i W,
 * a wall particle moving with 2 v_wall - v_i, which makes it the transpose of the pressure gradient
 * of pressure_difference.h; beside adami's walls, whose pressure is their own, with v_wall.
 * (Monaghan 1994, eq. 2.4, with the volume of a particle kept; density by summation would take
 * the unevenness of the particles for pressure.) */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_DENSITY_CONTINUITY_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_DENSITY_CONTINUITY_H

#include "sphsolve/wcsph/engine/simd.h"

/* Factor of slope in the divergence. */
SIMD_INLINE vec density_continuity_pair(vec x, vec y, vec z, vec dvx, vec dvy, vec dvz) {
  return x * dvx + y * dvy + z * dvz;
}

/* The pairs with walls need one sum for all velocities, S = sum_w slope x, for walls that move
 * T = sum_w slope x . v_w as well: their part of the divergence is 2 (T - v_i . S). */
SIMD_INLINE void density_continuity_wall(vec slope, vec x, vec y, vec z, vec sum[3]) {
  sum[0] += slope * x;
  sum[1] += slope * y;
  sum[2] += slope * z;
}

#endif

#ifdef EFFECTS
#include "sphsolve/wcsph/scales.h"
EFFECT(density_continuity, .model = "pressure from the divergence of the velocity",
       .citation = "Monaghan 1994, eq. 2.4", .wanted = wcsph_continuity_wanted)
#endif
