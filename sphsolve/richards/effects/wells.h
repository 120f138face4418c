/* Wells and drains take water out of the soil in them, as far as its pressure yields it:
 * richards/edges.c. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_EFFECTS_WELLS_H
#define TOSUI_SPHSOLVE_RICHARDS_EFFECTS_WELLS_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool richards_wells_wanted(const struct effect_context *context,
                                         char why[EFFECT_WHY]) {
  bool has = false;
  for (size_t r = 0; r < context->scene->region_count; r++)
    has = has || context->scene->regions[r].type == REGION_WELL ||
          context->scene->regions[r].type == REGION_DRAIN;
  snprintf(why, EFFECT_WHY, has ? "wells or drains" : "no well, no drain");
  return has;
}

#endif

EFFECT(richards_wells, .model = "a rate or a head, limited by the soil's pressure",
       .citation = "docs/physics/richards.md", .drives = true, .wanted = richards_wells_wanted)
