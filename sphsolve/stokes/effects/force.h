/* Driving of the flow: gravity + body acceleration - imposed pressure gradient / rho, and moving
 * walls. The flow is linear in it. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_FORCE_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_FORCE_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool stokes_force_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  if (context->driving > 0.0)
    snprintf(why, EFFECT_WHY, "%g m/s^2 drive the flow", context->driving);
  else
    snprintf(why, EFFECT_WHY, "gravity, body_acceleration and pressure_gradient add up to 0");
  return context->driving > 0.0;
}

#endif

EFFECT(stokes_force, .model = "uniform driving acceleration", .citation = "momentum equation",
       .wanted = stokes_force_wanted)
