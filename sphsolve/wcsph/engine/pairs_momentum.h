/* The momentum equation of one particle; the loops compute its terms:
 *
 * v' = (v + dt (F + a_pressure + a_other)) / (1 + dt K)
 *
 * F is gravity, acceleration and mean pressure gradient (body_force); K v' is the
 * friction at sub-voxel walls, taken with the new velocity so that particles close to a wall do not
 * limit the step. Forces of effects with their own file act before (engine_kick.c). */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_MOMENTUM_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_MOMENTUM_H

#include "sphsolve/wcsph/engine/pairs.h"
#include "sphsolve/wcsph/engine/simd.h"

/* F + a_pressure along axis a, m/s^2; the loops add the other terms. */
SIMD_INLINE double momentum_change(const struct pass *pass, int a, double pressed) {
  return pass->force[a] + pressed;
}

/* v'; `stiff`: dt K. */
SIMD_INLINE double momentum_next(const struct pass *pass, double v, double change, double stiff) {
  return (v + pass->dt * change) / (1 + stiff);
}

#endif
