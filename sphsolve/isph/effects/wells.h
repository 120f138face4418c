/* Wells of given rate and drains of given head take water out of soil: isph/well.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_WELLS_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_WELLS_H

#include <stdio.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"

static inline bool isph_wells_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  size_t wells = 0, drains = 0;
  for (size_t k = 0; k < context->scene->region_count; k = context->scene->regions[k].end) {
    wells += context->scene->regions[k].type == REGION_WELL;
    drains += context->scene->regions[k].type == REGION_DRAIN;
  }
  if (wells + drains == 0)
    snprintf(why, EFFECT_WHY, "no well or drain region");
  else
    snprintf(why, EFFECT_WHY, "%zu well%s of given rate, %zu drain%s", wells, wells == 1 ? "" : "s",
             drains, drains == 1 ? "" : "s");
  return wells + drains > 0;
}

#endif

EFFECT(isph_wells, .model = "div v = -q in a region of soil; a drain's q holds its pressure",
       .citation = "Bear 1972, 7.1", .wanted = isph_wells_wanted, .drives = true,
       .switches_on = EFFECT_SWITCH(struct isph_switches, wells), .budget = 1u << BUDGET_LEFT)
