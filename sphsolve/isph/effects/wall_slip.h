/* Walls with slip: mirrored images, normal velocity only (Asai et al. 2013); isph/wall.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_SLIP_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_SLIP_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/state.h"

/* Whether the scene has a wall with, or without, slip. */
static inline bool isph_wall_kind(const struct effect_context *context, bool slip) {
  const struct scene *scene = context->scene;
  for (int a = 0; a < 3; a++)
    if (!scene->periodic[a] && scene->isph.slip == slip && (scene->dimensions == 3 || a != 1))
      return true;
  for (size_t k = 0; k < scene->region_count; k++)
    if (scene->regions[k].type == REGION_WALL && scene->regions[k].slip == slip) return true;
  return false;
}

static inline bool isph_slip_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool on = isph_wall_kind(context, true);
  snprintf(why, EFFECT_WHY, on ? "walls with slip = true" : "no wall with slip = true");
  return on;
}

#endif

EFFECT(isph_wall_slip, .model = "mirrored images, normal velocity only",
       .citation = "Asai et al. 2013", .wanted = isph_slip_wanted)
