/* Walls that move with a prescribed velocity, and push or drag the water (Asai et al. 2013):
 * isph/wall.c moves them, their images have their velocity. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_MOVING_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_MOVING_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/wall.h"

static inline bool isph_moving_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY,
           context->has_moving_wall ? "a wall region has a velocity" : "no wall moves");
  return context->has_moving_wall;
}

static inline enum status isph_walls_moved(void *state, double dt) {
  isph_wall_move(state, dt);
  return isph_sort_walls(state);
}

#endif

EFFECT(isph_wall_moving, .model = "walls move with prescribed velocity",
       .citation = "Asai et al. 2013", .wanted = isph_moving_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, moving_walls), .moved = isph_walls_moved)
