/* Particle shifting: particles drift towards lower particle concentration, so that diverging
 * streamlines leave no voids (Lind et al. 2012, eq. 15):
 *
 * dx_i/dt = v_i + u_i, u_i = -A U h sum_j V grad_i W,
 *
 * U the largest fluid speed, |u_i| <= U/4. Velocity and pressure are transported along (Sun et al.
 * 2019, eq. 2):
 *
 * dv_i/dt += (u_i . grad) v_i, dp_i/dt += (u_i . grad) p_i.
 *
 * With A = 1 a Taylor-Green flow at Re 100 still develops voids. A larger A is better up to the
 * limit of an explicit step,
 *
 * A U h K dt < 2, K the largest eigenvalue of sum V grad W on the lattice.
 *
 * Beyond it particles oscillate at U/4 and drain the energy of the flow. So A = 16 where the step
 * permits it, and the step is chosen to permit 12. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_SHIFTING_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_SHIFTING_H

#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/engine/simd.h"

SIMD_INLINE void shifting_pair(vec slope, vec x, vec y, vec z, vec sum[3]) {
  sum[0] += slope * x;
  sum[1] += slope * y;
  sum[2] += slope * z;
}

/* Adds the factor of slope (f_j - f_i) in (u_i . grad) f. */
SIMD_INLINE vec shifting_carry(vec factor, vec x, vec y, vec z, const vec u[3]) {
  return factor + u[0] * x + u[1] * y + u[2] * z;
}

#ifdef EFFECTS /* for the plan alone (effects.c) */
#include <stdio.h>

#include "sphsolve/wcsph/scales.h"

static inline bool wcsph_shifting_wanted(const struct effect_context *context,
                                         char why[EFFECT_WHY]) {
  enum switch_state chosen = context->scene->shifting;
  if (chosen != SWITCH_AUTO) {
    snprintf(why, EFFECT_WHY, "the scene says %s", chosen == SWITCH_ON ? "on" : "off");
    return chosen == SWITCH_ON;
  }
  const bool frozen = wcsph_frozen(context), eulerian = wcsph_eulerian(context, NULL);
  snprintf(why, EFFECT_WHY,
           frozen     ? "summed densities keep particles apart as the paper has it"
           : eulerian ? "particles stay on their lattice points"
                      : "differences of pressure do not keep particles apart");
  return !frozen && !eulerian;
}

static inline double wcsph_shifting_dt(const struct effect_context *context) {
  return SHIFTING_STABLE / (SHIFTING_STRENGTH_LEAST * context->velocity_scale *
                            context->smoothing_length * wcsph_modes_of(context).shifting_stiffness);
}
#endif

#endif

#ifdef EFFECTS
EFFECT(shifting, .model = "particles drift to where they are fewer",
       .citation = "Lind et al. 2012, eq. 15; Sun et al. 2019, eq. 2",
       .wanted = wcsph_shifting_wanted, .dt_max = wcsph_shifting_dt, .dt_power = 1,
       .dt_accuracy = true, .switches_on = EFFECT_SWITCH(struct engine_settings, shift),
       .budget = 1u << BUDGET_SHIFTING)
#endif
