/* Wall sites mirror the kernel average of the velocity of the fluid around them:
 * v_b = 2 v_wall - <v>_b, <v>_b = sum over pore sites of W v / sum of W (Adami, Hu, Adams 2012,
 * eq. 22 and 23). Second order for walls half-way between sites. Not self-adjoint: solved by defect
 * correction of the system with v_b = 2 v_wall - v_a. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_WALL_ADAMI_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_WALL_ADAMI_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool stokes_wall_adami_wanted(const struct effect_context *context,
                                            char why[EFFECT_WHY]) {
  const bool on = context->has_wall && context->scene->stokes.wall == WALL_ADAMI;
  snprintf(why, EFFECT_WHY, on ? "stokes.wall = \"adami\"" : "stokes.wall is another");
  return on;
}

#endif

EFFECT(stokes_wall_adami,
       .model = "wall points mirror the average velocity of the fluid around them",
       .citation = "Adami, Hu, Adams 2012, eq. 22, 23", .wanted = stokes_wall_adami_wanted)
