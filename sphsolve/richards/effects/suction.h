/* Conductivity by Mualem (1976) and van Genuchten (1980), eq. 8, with S the effective saturation,
 *   K = K_s S^l (1 - (1 - S^(1/m))^m)^2
 * and the flux by suction, which is exactly int K dh between two sites: richards/flux.h. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_EFFECTS_SUCTION_H
#define TOSUI_SPHSOLVE_RICHARDS_EFFECTS_SUCTION_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool richards_suction_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  (void)context;
  snprintf(why, EFFECT_WHY, "the soil has a retention curve");
  return true;
}

#endif

EFFECT(richards_suction, .model = "Darcy's flux by the gradient of the pressure head",
       .citation = "Mualem 1976; van Genuchten 1980, eq. 8", .wanted = richards_suction_wanted)
