/* Sides of given head or flux, through which water comes and goes: isph/open.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_OPEN_SIDE_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_OPEN_SIDE_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/state.h"

static inline bool isph_open_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->has_inflow ? "inflow regions" : "no inflow region");
  return context->has_inflow;
}

#endif

EFFECT(isph_open_side, .model = "fixed head or flux on a side", .citation = "docs/physics/isph.md",
       .wanted = isph_open_wanted, .switches_on = EFFECT_SWITCH(struct isph_switches, open_sides),
       .budget = 1u << BUDGET_OPEN_SIDES | 1u << BUDGET_ENTERED | 1u << BUDGET_LEFT |
                 1u << BUDGET_STRAIGHTENING)
