/* Walls that move with a prescribed velocity, and push or drag the water (Asai et al. 2013):
 * isph/wall.c moves them, their images have their velocity. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_MOVING_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_MOVING_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/state.h"

static inline bool isph_moving_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY,
           context->has_moving_wall ? "a wall region has a velocity" : "no wall moves");
  return context->has_moving_wall;
}

#endif

EFFECT(isph_wall_moving, .model = "walls move with prescribed velocity",
       .citation = "Asai et al. 2013", .wanted = isph_moving_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, moving_walls))
