/* Forchheimer drag of the soil, quadratic in the velocity: b |v_D| v_D, b = beta (1 - eps) / (eps^3
 * D50) (M15 eq. 9d), implicit together with the linear drag; equation in drag_linear.h. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_DRAG_FORCHHEIMER_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_DRAG_FORCHHEIMER_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/effects/porosity.h"

static inline double isph_forchheimer_of(const struct region *region) {
  return region->beta;
}

/* Darcy speed of particle i relative to the soil, m/s: |v_D - eps v_soil|. */
static inline double isph_speed_through_soil(const struct isph *s, size_t i) {
  double square = 0;
  for (int a = 0; a < 3; a++) {
    const double soil = s->on.moving_soil ? s->porosity[i] * s->soil_velocity[i][a] : 0;
    square += (s->velocity[i][a] - soil) * (s->velocity[i][a] - soil);
  }
  return sqrt(square);
}

static inline bool isph_forchheimer_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  bool on = isph_any_soil(context->scene, isph_forchheimer_of);
  snprintf(why, EFFECT_WHY, on ? "soil with beta > 0" : "no soil with beta > 0");
  return on;
}

#endif

EFFECT(isph_drag_forchheimer, .model = "b = beta (1-eps) / (eps^3 D50), Newton-linearised",
       .citation = "Morimoto et al. 2015 (9d)", .wanted = isph_forchheimer_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, drag_forchheimer),
       .budget = 1u << BUDGET_DRAG_FORCHHEIMER)
