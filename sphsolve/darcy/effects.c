#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/darcy/method.h"

static bool richards_storage_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  const bool holds_air = !domain_is_full(context->scene);
  snprintf(why, EFFECT_WHY,
           holds_air ? "the soil has a retention curve" : "the soil stays full of water");
  return holds_air;
}

static bool richards_suction_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  return richards_storage_wanted(context, why);
}

static bool richards_pressure_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  return !richards_storage_wanted(context, why);
}

static bool richards_forchheimer_wanted(const struct effect_context *context,
                                        char why[EFFECT_WHY]) {
  bool drags = false;
  for (size_t r = 0; r < context->scene->region_count; r++)
    drags = drags || (context->scene->regions[r].type == REGION_POROUS &&
                      context->scene->regions[r].beta > 0);
  const bool on = drags && domain_is_full(context->scene);
  snprintf(why, EFFECT_WHY,
           on      ? "soil has a grain size, and beta is not 0"
           : drags ? "soil that is not full follows Darcy's law"
                   : "no soil has a grain size and a beta above 0");
  return on;
}

static bool richards_gravity_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->driving > 0 ? "gravity pulls" : "the scene has no gravity");
  return context->driving > 0;
}

static bool richards_layers_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  const struct scene *scene = context->scene;
  const struct region *first = NULL;
  bool differ = false;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type != REGION_POROUS) continue;
    if (first == NULL) first = region;
    const struct retention_curve *a = &first->retention, *b = &region->retention;
    differ = differ || region->porosity != first->porosity ||
             region->permeability != first->permeability || region->alpha != first->alpha ||
             region->grain_size != first->grain_size || a->alpha != b->alpha ||
             a->exponential != b->exponential || a->n != b->n || a->theta_r != b->theta_r ||
             a->l != b->l;
  }
  snprintf(why, EFFECT_WHY, differ ? "soils differ" : "one soil");
  return differ;
}

static bool richards_beds_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool beds = false;
  for (size_t r = 0; r < context->scene->region_count; r++)
    beds = beds || context->scene->regions[r].anisotropic;
  snprintf(why, EFFECT_WHY, beds ? "a permeability for each axis" : "soil is permeable alike");
  return beds;
}

static bool richards_open_side_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->has_inflow ? "inflow regions" : "no inflow region");
  return context->has_inflow;
}

static bool richards_air_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool level = false;
  for (size_t r = 0; r < context->scene->region_count; r++)
    level = level || context->scene->regions[r].boundary == BOUNDARY_HEAD;
  const bool air = context->has_surface || context->has_rain || level;
  snprintf(why, EFFECT_WHY,
           air ? "soil has faces to the air" : "no face of the soil is open to the air");
  return air;
}

static bool richards_rain_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->has_rain ? "rain regions" : "no rain region");
  return context->has_rain;
}

static bool richards_ponding_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool stands = scene_has_region(context->scene, REGION_WATER) && !domain_is_full(context->scene);
  for (size_t r = 0; r < context->scene->region_count; r++)
    stands = stands || context->scene->regions[r].ponding > 0;
  snprintf(why, EFFECT_WHY,
           stands ? "rain with a ponding depth, or free water"
                  : "no rain with a ponding depth, no free water");
  return stands;
}

static bool richards_wells_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  const bool has = scene_has_region(context->scene, REGION_WELL) ||
                   scene_has_region(context->scene, REGION_DRAIN);
  snprintf(why, EFFECT_WHY, has ? "wells or drains" : "no well, no drain");
  return has;
}

#define EFFECTS richards_effects
#define EFFECTS_REGISTRY "sphsolve/darcy/effects/registry.def"
#include "sphsolve/plan/effect_list.h"
