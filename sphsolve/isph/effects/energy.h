/* Bound on the energy: if only a steady, uniform force can give the water energy, the sum of
 * kinetic and potential energy may not increase; an excess that a step has added is removed.
 * Equations and reasons: isph/energy.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_ENERGY_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_ENERGY_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/effects/artificial_viscosity.h"
#include "sphsolve/isph/effects/soil_moving.h"
#include "sphsolve/isph/method.h"

static inline bool isph_energy_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  char unused[EFFECT_WHY];
  const struct scene *scene = context->scene;
  bool round = false, driven = false;
  for (size_t i = 0; isph_effects[i] != NULL; i++)
    driven = driven || (isph_effects[i]->drives && isph_effects[i]->wanted(context, unused));
  for (int a = 0; a < 3; a++) round = round || (scene->periodic[a] && scene->driving[a] != 0);
  bool on = isph_artificial_viscosity_wanted(context, unused) && !context->has_inflow &&
            !context->has_moving_wall && !isph_any_soil(scene, isph_motion_of) && !round && !driven;
  snprintf(why, EFFECT_WHY,
           on ? "a surface under a force, and nothing else drives the water"
              : "no surface under a force, or something else drives the water");
  return on;
}

#endif

EFFECT(isph_energy, .model = "kinetic and potential energy together may not grow",
       .citation = "docs/physics/isph.md", .wanted = isph_energy_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, energy),
       .budget = 1u << BUDGET_ENERGY_BOUND)
