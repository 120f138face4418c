/* Laminar viscosity.
 *   dv_i/dt = sum_j m (mu_i + mu_j)/(rho_i rho_j) (1/r) dW/dr (v_i - v_j)
 *                                                       Morris, Fox, Zhu (1997), eq. 22 */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_VISCOSITY_MORRIS_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_VISCOSITY_MORRIS_H

#include "sphsolve/wcsph/engine/simd.h"

SIMD_INLINE void viscosity_morris_pair(vec weight, vec dvx, vec dvy, vec dvz, vec sum[3]) {
  sum[0] += weight * dvx;
  sum[1] += weight * dvy;
  sum[2] += weight * dvz;
}

#ifdef EFFECTS /* for the plan alone (effects.c) */
#include <stdio.h>

#include "sphsolve/wcsph/scales.h"

static inline bool wcsph_viscosity_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, "viscosity %.4g m^2/s", context->kinematic_viscosity);
  return context->kinematic_viscosity > 0;
}

static inline double wcsph_viscosity_dt(const struct effect_context *context) {
  return 2 / (context->kinematic_viscosity * wcsph_modes_of(context).laplacian);
}
#endif

#endif

#ifdef EFFECTS
EFFECT(viscosity_morris, .model = "laminar viscosity", .citation = "Morris, Fox, Zhu 1997, eq. 22",
       .wanted = wcsph_viscosity_wanted, .dt_max = wcsph_viscosity_dt, .dt_power = 2,
       .switches_on = EFFECT_SWITCH(struct engine_settings, viscous),
       .budget = 1u << BUDGET_VISCOSITY)
#endif
