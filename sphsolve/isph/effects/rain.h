/* Rain of given rate onto water, soil and ground: isph/rain.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_RAIN_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_RAIN_H

#include <stdio.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"

static inline bool isph_rain_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->has_rain ? "rain regions" : "no rain region");
  return context->has_rain;
}

#endif

EFFECT(isph_rain, .model = "water of a given rate, in whole particles on what lies below",
       .citation = "docs/physics/isph.md", .wanted = isph_rain_wanted, .drives = true,
       .switches_on = EFFECT_SWITCH(struct isph_switches, rain), .budget = 1u << BUDGET_ENTERED)
