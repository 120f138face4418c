/* The table of methods, and the choice of a method for a scene. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/plan/constants.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"

const struct method *const methods_all[] = {
#define METHOD(name) &method_##name,
#include "sphsolve/scene/methods.def"
#undef METHOD
    NULL};

/* Methods are asked from the last to the first; the first one takes everything else. */
static const struct method *choose_method(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  size_t i = 0;
  while (methods_all[i + 1] != NULL) i++;
  while (i > 0 && !methods_all[i]->takes(context, why)) i--;
  if (i == 0) methods_all[0]->takes(context, why);
  return methods_all[i];
}

int plan_wall_layers(const struct scene *scene) {
  char why[EFFECT_WHY];
  struct effect_context context;
  plan_context(scene, NULL, &context);
  return (scene->method != NULL ? scene->method : choose_method(&context, why))->wall_layers;
}

/* A wall may be displaced only if its method allows it; it may move along itself, as a lid does. */
static enum status refuse_displacement(const struct scene *scene) {
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    for (int a = 0; a < 3; a++)
      if (region->type == REGION_WALL && region->velocity[a] != 0 &&
          region->box[a + 3] - region->box[a] < WHOLE_WIDTH * scene->domain_size[a])
        return FAIL(STATUS_INPUT,
                    "%s:%d: regions: this wall ends in %c, and moves along it; walls of this "
                    "method stay where they are: let it reach through the domain, or write method "
                    "= \"isph\"",
                    scene->path, region->line, 'x' + a);
  }
  return STATUS_OK;
}

static bool has_field(const struct method *method, const char *name) {
  for (size_t k = 0; method->fields != NULL && method->fields[k] != NULL; k++)
    if (!strcmp(name, method->fields[k])) return true;
  return false;
}

static enum status refuse_fields(const struct scene *scene, const struct method *method) {
  for (size_t i = 0; i < scene->output_field_count; i++) {
    const char *name = scene->output_fields[i];
    for (size_t m = 0; methods_all[m] != NULL && !has_field(method, name); m++)
      if (has_field(methods_all[m], name))
        return scene_error(scene, AT_FIELDS, "\"%s\" is a field of method %s; leave it out", name,
                           methods_all[m]->name);
  }
  return STATUS_OK;
}

/* Rejects settings that are valid alone but not in combination. */
static enum status refuse_contradictions(const struct scene *scene,
                                         const struct effect_context *context,
                                         const struct method *method) {
  enum status status = STATUS_OK;
  const struct lattice *lattice = context->lattice;
  bool driven = false, held = false, moves = context->has_moving_wall;
  char unused[EFFECT_WHY];
  if (lattice->fluid_count == 0 && !context->has_inflow && !context->has_rain)
    return scene_error(scene, *scene->model_path ? AT_MODEL : AT_REGIONS, "no site holds water; %s",
                       *scene->model_path ? "the model is all grain: look at its threshold"
                                          : "add a water region, or make it larger");
  for (int a = 0; a < 3; a++) {
    driven = driven || scene->driving[a] != 0;
    held = held || (scene->driving[a] != 0 && !scene->periodic[a]);
  }
  if (driven && !held && context->has_surface)
    return scene_error(scene, AT_PERIODIC,
                       "the domain repeats along the force, so water with a free surface would "
                       "fall for ever; write false for that direction, or fill the domain");
  for (size_t r = 0; r < scene->region_count; r++)
    for (int a = 0; a < 3; a++) moves = moves || scene->regions[r].velocity[a] != 0;
  for (size_t i = 0; method->effects[i] != NULL; i++)
    moves = moves || (method->effects[i]->drives && method->effects[i]->wanted(context, unused));
  if (!driven && !moves && !context->has_inflow)
    return scene_error(scene, AT_FORCE,
                       "nothing drives a flow; give a gravity, body_acceleration or "
                       "pressure_gradient, or a region that moves");
  if (!lattice_holds_fluid(lattice) && method->resolves_pores &&
      (!method->marches || !isfinite(scene->end_time)))
    return scene_error(
        scene, AT_METHOD,
        "no wall holds the fluid back, so a steady flow does not exist; add a wall%s "
        "or write method = \"wcsph\" and an end_time",
        *scene->model_path ? " (the model is all pore: look at its threshold)," : ",");
  if (scene->fluid.surface_tension > 0 && method->resolves_pores)
    return scene_error(scene, AT_VISCOSITY,
                       "surface_tension, but method %s has no free surface; leave it out",
                       method->name);
  for (size_t r = 0; r < scene->region_count; r++)
    if (scene->regions[r].table.count > 0 && method->resolves_pores)
      return FAIL(STATUS_INPUT, "%s:%d: times are for method isph; method %s takes one velocity",
                  scene->path, scene->regions[r].line, method->name);
  if (scene->turbulence == SWITCH_ON && !method->has_turbulence)
    return scene_error(scene, AT_TURBULENCE,
                       "\"on\", but only method isph has a model of turbulence; leave it out");
  if (scene->turbulence == SWITCH_ON && !(scene->isph.smagorinsky > 0))
    return scene_error(scene, AT_TURBULENCE,
                       "\"on\", but isph.smagorinsky = 0 takes all of it away; give one of them");
  if (scene->shifting == SWITCH_ON && !method->marches)
    return scene_error(scene, AT_SHIFTING, "\"on\", but nothing moves in method %s; leave it out",
                       method->name);
  TRY(refuse_fields(scene, method));
  if (!method->moves_walls) TRY(refuse_displacement(scene));
cleanup:
  return status;
}

enum status plan_method(const struct scene *scene, const struct lattice *lattice,
                        const struct method **chosen, char why[EFFECT_WHY]) {
  struct effect_context context;
  const struct method *method = scene->method;
  plan_context(scene, lattice, &context);
  plan_estimate_seepage(&context);
  if (method != NULL)
    snprintf(why, EFFECT_WHY, "the scene says so");
  else
    method = choose_method(&context, why);
  *chosen = method;
  if ((scene->micro.factor_count > 0 || scene->micro.uncertainty > 1) &&
      lattice->micro_porosity == NULL)
    return scene_error(scene, AT_MICRO,
                       "%s has no soil with pores below the voxel; leave the group out, or build a "
                       "model with such soil (ct2model build --micro)",
                       scene->model_path);
  if (method->resolves_pores) {
    if (context.has_porous || context.has_inflow || context.has_rain || context.has_absorbing)
      return scene_error(
          scene, AT_METHOD,
          "method %s knows no soil, inflow, rain or absorbing side; write method = \"isph\"",
          method->name);
    if (context.has_surface)
      return scene_error(scene, AT_METHOD,
                         "method %s needs a filled domain, but %zu of %zu points are empty; fill "
                         "them with a water region, or write method = \"isph\"",
                         method->name, lattice->count - lattice->fluid_count - lattice->wall_count,
                         lattice->count);
    if (lattice->micro_porosity != NULL && !method->takes_soil)
      return scene_error(scene, AT_METHOD,
                         "the model has soil with pores below the voxel, through which method %s "
                         "has no flow; write method = \"stokes\", or make it pore or grain "
                         "(ct2model build)",
                         method->name);
    if (!(scene->fluid.viscosity > 0))
      return scene_error(scene, AT_VISCOSITY,
                         "method %s needs a viscosity greater than 0, like \"1e-3 Pa s\"",
                         method->name);
  } else if (*scene->model_path) {
    return scene_error(
        scene, AT_METHOD,
        "method %s takes a domain with regions, not a voxel model; use "
        "method = %s\"stokes\"%s",
        method->name, lattice->micro_porosity != NULL ? "" : "\"wcsph\" or ",
        lattice->micro_porosity != NULL ? ", which solves the model's soil with the pores" : "");
  }
  return refuse_contradictions(scene, &context, method);
}
