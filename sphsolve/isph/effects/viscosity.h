/* Laminar and eddy viscosity (M15 eq. 22): nu_E lap v, nu_E = (nu + nu_T)/eps, by pairs,
 *   sum_j V_j (nu_i + nu_j) (-W'/r) (v_j - v_i),
 * isph/viscosity.c; walls: wall_no_slip.h. Explicit: dt <= .1 dx^2/nu. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_VISCOSITY_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_VISCOSITY_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/effects/turbulence.h"
#include "sphsolve/isph/viscosity.h"
#include "sphsolve/isph/constants.h"

static inline bool isph_viscosity_wanted(const struct effect_context *context,
                                         char why[EFFECT_WHY]) {
  char unused[EFFECT_WHY];
  bool eddies = isph_turbulence_wanted(context, unused),
       on = context->kinematic_viscosity > 0 || eddies;
  snprintf(why, EFFECT_WHY, on ? "nu = %g m^2/s%s" : "an ideal fluid", context->kinematic_viscosity,
           eddies ? " and eddies" : "");
  return on;
}

static inline double isph_viscosity_dt(const struct effect_context *context) {
  /* nu_E T = nu dt / C_r: soil only makes it more stable */
  return DT_VISCOSITY * context->spacing * context->spacing /
         fmax(context->kinematic_viscosity, 1e-300);
}

static inline enum status isph_viscosity_begin(void *state, double dt) {
  (void)dt;
  isph_viscosity_find(state);
  return STATUS_OK;
}

/* As isph_viscosity_dt, with the present eddies. */
static inline double isph_viscosity_stable_dt(const void *state) {
  const struct isph *s = state;
  return DT_VISCOSITY * s->spacing * s->spacing / fmax(s->kinematic_viscosity, s->viscosity_most);
}

#endif

EFFECT(isph_viscosity, .model = "nu_E lap v, nu_E = (nu + nu_T)/eps",
       .citation = "Morimoto et al. 2015 (22)", .wanted = isph_viscosity_wanted,
       .dt_max = isph_viscosity_dt, .switches_on = EFFECT_SWITCH(struct isph_switches, viscous),
       .budget = 1u << BUDGET_VISCOSITY, .begin = isph_viscosity_begin,
       .stable_dt = isph_viscosity_stable_dt)
