/* Uniform gravity, acceleration and mean pressure gradient: dv_i/dt = f (Saomoto et al. 2006, eq.
 * 7). */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_BODY_FORCE_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_BODY_FORCE_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/wcsph/scales.h"

static inline bool wcsph_body_force_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  if (context->driving > 0)
    snprintf(why, EFFECT_WHY, "force: %.4g m/s^2", context->driving);
  else
    snprintf(why, EFFECT_WHY, "no gravity, acceleration or pressure gradient");
  return context->driving > 0;
}

/* Monaghan (1992): in one step a force moves a particle from rest by at most h/32. */
static inline double wcsph_body_force_dt(const struct effect_context *context) {
  return 0.25 * sqrt(context->smoothing_length / context->driving);
}

#endif

EFFECT(body_force, .model = "gravity, acceleration and mean pressure gradient, the same everywhere",
       .citation = "Saomoto et al. 2006, eq. 7", .wanted = wcsph_body_force_wanted,
       .dt_max = wcsph_body_force_dt, .dt_power = 1, .dt_accuracy = true,
       .budget = 1u << BUDGET_FORCE)
