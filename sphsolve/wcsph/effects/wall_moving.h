/* Walls that move in their own plane with a prescribed velocity v_w, for the image velocities of
 * wall_subvoxel.h and wall_adami.h (Morris, Fox, Zhu 1997). */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_WALL_MOVING_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_WALL_MOVING_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/wcsph/scales.h"

static inline bool wcsph_wall_moving_wanted(const struct effect_context *context,
                                            char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY,
           context->has_moving_wall ? "a wall region has a velocity" : "no wall moves");
  return context->has_moving_wall && context->has_wall;
}

#endif

EFFECT(wall_moving, .model = "walls with a prescribed velocity in their own plane",
       .citation = "Morris, Fox, Zhu 1997", .wanted = wcsph_wall_moving_wanted,
       .switches_on = EFFECT_SWITCH(struct engine_settings, wall_moves))
