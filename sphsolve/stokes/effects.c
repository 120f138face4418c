#include <stdio.h>

#include "sphsolve/output/conservation.h"
#include "sphsolve/stokes/method.h"

static bool stokes_force_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  if (context->driving > 0.0)
    snprintf(why, EFFECT_WHY, "%g m/s^2 drive the flow", context->driving);
  else
    snprintf(why, EFFECT_WHY, "gravity, body_acceleration and pressure_gradient add up to 0");
  return context->driving > 0.0;
}

static bool has_walls(const struct effect_context *context, enum wall_scheme wall,
                      char why[EFFECT_WHY]) {
  const bool on = context->has_wall && context->scene->stokes.wall == wall;
  if (on)
    snprintf(why, EFFECT_WHY, "stokes.wall = \"%s\"", wall_scheme_names[wall]);
  else
    snprintf(why, EFFECT_WHY, "stokes.wall is another");
  return on;
}

static bool stokes_wall_frozen_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  return has_walls(context, WALL_FROZEN, why);
}

static bool stokes_wall_adami_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  return has_walls(context, WALL_ADAMI, why);
}

#define EFFECTS stokes_effects
#define EFFECTS_REGISTRY "sphsolve/stokes/effects/registry.def"
#include "sphsolve/plan/effect_list.h"
