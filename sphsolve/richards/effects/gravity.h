/* Flux by gravity: K times its component along a face, with K as steady flow between the two sites
 * has it: richards/flux.h. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_EFFECTS_GRAVITY_H
#define TOSUI_SPHSOLVE_RICHARDS_EFFECTS_GRAVITY_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool richards_gravity_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->driving > 0 ? "gravity pulls" : "the scene has no gravity");
  return context->driving > 0;
}

#endif

EFFECT(richards_gravity, .model = "Darcy's flux by gravity",
       .citation = "Richards 1931; Scharfetter, Gummel 1969", .wanted = richards_gravity_wanted)
