/* Wall sites have the velocity of the wall: v_b = v_wall. Every gap is one spacing too wide
 * (Saomoto, Matsushima, Yamada, Hatano 2006); for comparison with that paper. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_WALL_FROZEN_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_WALL_FROZEN_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool stokes_wall_frozen_wanted(const struct effect_context *context,
                                             char why[EFFECT_WHY]) {
  const bool on = context->has_wall && context->scene->stokes.wall == WALL_FROZEN;
  snprintf(why, EFFECT_WHY, on ? "stokes.wall = \"frozen\"" : "stokes.wall is another");
  return on;
}

#endif

EFFECT(stokes_wall_frozen, .model = "wall points at rest; every gap one spacing too wide",
       .citation = "Saomoto, Matsushima, Yamada, Hatano 2006", .wanted = stokes_wall_frozen_wanted)
