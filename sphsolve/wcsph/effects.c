#include <math.h>
#include <stdio.h>

#include "sphsolve/output/conservation.h"
#include "sphsolve/wcsph/plan.h"

static bool wcsph_body_force_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  if (context->driving > 0)
    snprintf(why, EFFECT_WHY, "force: %.4g m/s^2", context->driving);
  else
    snprintf(why, EFFECT_WHY, "no gravity, acceleration or pressure gradient");
  return context->driving > 0;
}

/* Monaghan (1992): in one step a force moves a particle from rest by at most h/32. */
static double wcsph_body_force_dt(const struct effect_context *context) {
  return 0.25 * sqrt(context->smoothing_length / context->driving);
}

static bool wcsph_wall_frozen_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  return wcsph_wall_wanted(context, WALL_FROZEN, why);
}

static bool wcsph_wall_moving_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY,
           context->has_moving_wall ? "a wall region has a velocity" : "no wall moves");
  return context->has_moving_wall && context->has_wall;
}

#define EFFECTS wcsph_effects
#define EFFECTS_REGISTRY "sphsolve/wcsph/effects/registry.def"
#include "sphsolve/plan/effect_list.h"
