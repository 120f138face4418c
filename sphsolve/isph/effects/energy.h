/* Bound on the energy of water that lies on soil: if only a steady, uniform force can give it
 * energy, the sum of kinetic and potential energy may not increase; an excess that a step has added
 * is removed. Equations and reasons: isph/energy.c. Free water has no such bound: its steps are
 * symplectic (isph/calm.h), the energy at a step swings about that which is conserved by omega dt/2
 * of a wave's, and to take it at each crest lowered the water and made waves grow. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_ENERGY_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_ENERGY_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/effects/artificial_viscosity.h"
#include "sphsolve/isph/effects/soil_moving.h"
#include "sphsolve/isph/method.h"
#include "sphsolve/isph/energy.h"

static inline bool isph_energy_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  char unused[EFFECT_WHY];
  const struct scene *scene = context->scene;
  bool round = false, driven = false;
  for (size_t i = 0; isph_effects[i] != NULL; i++)
    driven = driven || (isph_effects[i]->drives && isph_effects[i]->wanted(context, unused));
  for (int a = 0; a < 3; a++) round = round || (scene->periodic[a] && scene->driving[a] != 0);
  bool on = isph_artificial_viscosity_wanted(context, unused) && context->has_porous &&
            !context->has_inflow && !context->has_moving_wall &&
            !isph_any_soil(scene, isph_motion_of) && !round && !driven;
  snprintf(why, EFFECT_WHY,
           on ? "a surface over soil under a force, and nothing else drives the water"
              : "no surface over soil under a force, or something else drives the water");
  return on;
}

static inline enum status isph_energy_begins(void *state, double dt) {
  struct isph *s = state;
  (void)dt;
  s->energy_step = (struct isph_energy_step){.kinetic = isph_kinetic_energy(s), .total = s->total};
  s->energy_step.most = s->energy_step.kinetic + isph_potential_energy(s);
  return STATUS_OK;
}

static inline enum status isph_energy_predicted(void *state, double dt) {
  struct isph *s = state;
  isph_energy_find_friction(s);
  if (s->on.relaxation) isph_energy_limit_relaxation(s, s->relaxation_time, dt);
  return STATUS_OK;
}

static inline enum status isph_energy_corrected(void *state, double dt) {
  struct isph *s = state;
  s->energy_step.given = isph_energy_from_relaxation(s, s->relaxation_time, dt);
  return STATUS_OK;
}

static inline enum status isph_energy_moved(void *state, double dt) {
  struct isph *s = state;
  (void)dt;
  s->energy_step.moved = isph_kinetic_energy(s);
  return STATUS_OK;
}

/* Limits the energy that the new porosity and the walls' guard have added. */
static inline enum status isph_energy_settled(void *state, double dt) {
  struct isph *s = state;
  const struct isph_energy_step *step = &s->energy_step;
  (void)dt;
  if (s->total == step->total) isph_energy_limit_velocity(s, step->most + step->given, step->moved);
  return STATUS_OK;
}

#endif

EFFECT(isph_energy, .model = "kinetic and potential energy together may not grow",
       .citation = "docs/physics/isph.md", .wanted = isph_energy_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, energy),
       .budget = 1u << BUDGET_ENERGY_BOUND, .begin = isph_energy_begins,
       .predicted = isph_energy_predicted, .corrected = isph_energy_corrected,
       .moved = isph_energy_moved, .settled = isph_energy_settled)
