/* Pressure of a weakly compressible fluid from the divergence of the velocity.
 *
 * dp_i/dt = - rho_0 c^2 div v_i, div v_i = sum_j V (v_j - v_i) . grad_i W
 *
 * A wall particle has the velocity 2 v_wall - v_i, which makes this operator the transpose of the
 * pressure gradient of pressure_difference.h; with adami walls, which have their own pressure, it
 * has v_wall. (Monaghan 1994, eq. 2.4, with constant particle volume; density by summation would
 * interpret an uneven particle distribution as pressure.) */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_DENSITY_CONTINUITY_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_DENSITY_CONTINUITY_H

#include "sphsolve/wcsph/engine/simd.h"

/* Factor of the kernel gradient `slope` in the divergence. */
SIMD_INLINE vec density_continuity_pair(vec x, vec y, vec z, vec dvx, vec dvy, vec dvz) {
  return x * dvx + y * dvy + z * dvz;
}

/* Pairs with walls need one sum for all velocities, S = sum_w slope x, and for moving walls also T
 * = sum_w slope x . v_w: their part of the divergence is 2 (T - v_i . S). */
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
