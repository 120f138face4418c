/* Levels, pressure heads and fluxes on the sides of the domain: richards/edges.c. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_EFFECTS_OPEN_SIDE_H
#define TOSUI_SPHSOLVE_RICHARDS_EFFECTS_OPEN_SIDE_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool richards_open_side_wanted(const struct effect_context *context,
                                             char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->has_inflow ? "inflow regions" : "no inflow region");
  return context->has_inflow;
}

#endif

EFFECT(richards_open_side, .model = "heads and fluxes that are given on a side",
       .citation = "docs/physics/richards.md", .drives = true, .wanted = richards_open_side_wanted)
