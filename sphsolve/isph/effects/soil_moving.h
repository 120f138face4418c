/* Moving boxes of soil, which drag the water along: v in the drag is relative to eps v_soil, and
 * div v_D = -d eps/dt where the porosity of a place changes (M15 section 4(1)). */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_SOIL_MOVING_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_SOIL_MOVING_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/effects/porosity.h"

static inline double isph_motion_of(const struct region *region) {
  const double *v = region->soil_velocity;
  return fabs(v[0]) + fabs(v[1]) + fabs(v[2]);
}

static inline bool isph_soil_moving_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  bool on = isph_any_soil(context->scene, isph_motion_of);
  snprintf(why, EFFECT_WHY, on ? "a porous region has a velocity" : "no soil moves");
  return on;
}

static inline enum status isph_motion_moved(void *state, double dt) {
  struct isph *s = state;
  for (size_t k = 0; k < s->scene->region_count; k++)
    for (int a = 0; a < 3; a++) s->soil_offset[k][a] += s->scene->regions[k].soil_velocity[a] * dt;
  return STATUS_OK;
}

#endif

EFFECT(isph_soil_moving, .model = "soil boxes move and drag the water along",
       .citation = "Morimoto et al. 2015 section 4(1)", .wanted = isph_soil_moving_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, moving_soil), .moved = isph_motion_moved)
