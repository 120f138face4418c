/* Two soils in series between two sites: the head at their interface is where both halves of the
 * path carry the same flux: richards/flux.c. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_EFFECTS_LAYERS_H
#define TOSUI_SPHSOLVE_RICHARDS_EFFECTS_LAYERS_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool richards_layers_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  const struct scene *scene = context->scene;
  const struct region *first = NULL;
  bool differ = false;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type != REGION_POROUS) continue;
    if (first == NULL) first = region;
    const struct retention_curve *a = &first->retention, *b = &region->retention;
    differ = differ || region->porosity != first->porosity ||
             region->permeability != first->permeability || a->alpha != b->alpha || a->n != b->n ||
             a->theta_r != b->theta_r || a->l != b->l;
  }
  snprintf(why, EFFECT_WHY, differ ? "soils differ" : "one soil");
  return differ;
}

#endif

EFFECT(richards_layers, .model = "the head where two soils meet",
       .citation = "equal fluxes on both sides", .wanted = richards_layers_wanted)
