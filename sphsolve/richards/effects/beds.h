/* A conductivity for each axis, for soil with bedding along the axes. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_EFFECTS_BEDS_H
#define TOSUI_SPHSOLVE_RICHARDS_EFFECTS_BEDS_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool richards_beds_wanted(const struct effect_context *context,
                                        char why[EFFECT_WHY]) {
  bool beds = false;
  for (size_t r = 0; r < context->scene->region_count; r++)
    beds = beds || context->scene->regions[r].anisotropic;
  snprintf(why, EFFECT_WHY, beds ? "a permeability for each axis" : "soil is permeable alike");
  return beds;
}

#endif

EFFECT(richards_beds, .model = "another permeability along each axis", .citation = "Darcy's law",
       .wanted = richards_beds_wanted)
