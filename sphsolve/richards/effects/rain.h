/* Rain on the upper faces of soil, as much of it as soil without ponding takes; the rest runs off:
 * richards/edges.c. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_EFFECTS_RAIN_H
#define TOSUI_SPHSOLVE_RICHARDS_EFFECTS_RAIN_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool richards_rain_wanted(const struct effect_context *context,
                                        char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->has_rain ? "rain regions" : "no rain region");
  return context->has_rain;
}

#endif

EFFECT(richards_rain, .model = "a given flux, limited by what the soil takes",
       .citation = "docs/physics/richards.md", .drives = true, .wanted = richards_rain_wanted)
