/* Faces of soil to the air let out water that is under pressure, and none in (a seepage face;
 * Neuman 1973): richards/edges.c. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_EFFECTS_AIR_H
#define TOSUI_SPHSOLVE_RICHARDS_EFFECTS_AIR_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool richards_air_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool level = false;
  for (size_t r = 0; r < context->scene->region_count; r++)
    level = level || context->scene->regions[r].boundary == BOUNDARY_HEAD;
  const bool air = context->has_surface || context->has_rain || level;
  snprintf(why, EFFECT_WHY,
           air ? "soil has faces to the air" : "no face of the soil is open to the air");
  return air;
}

#endif

EFFECT(richards_air, .model = "water comes out where it is under pressure",
       .citation = "Neuman 1973", .wanted = richards_air_wanted)
