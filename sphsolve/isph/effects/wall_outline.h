/* Walls of soil that are polygons or circles count by their outline: isph/outline.h. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_OUTLINE_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_OUTLINE_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/outline.h"
#include "sphsolve/isph/state.h"

static inline bool isph_outline_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  const struct scene *scene = context->scene;
  bool any = false;
  for (size_t k = 0; k < scene->region_count; k++)
    any = any || isph_may_have_outline(scene, &scene->regions[k]);
  const bool full = context->has_porous && !context->has_surface;
  snprintf(why, EFFECT_WHY,
           !any    ? "no wall is a polygon or a circle"
           : !full ? "under a surface and in free water such walls are boxes of points"
                   : "walls that are polygons or circles");
  return any && full;
}

#endif

EFFECT(isph_wall_outline, .model = "shares of cells at an outline, and images along it",
       .citation = "docs/physics/isph.md", .wanted = isph_outline_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, outlines))
