#include "sphsolve/plan/plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/units.h"
#include "sphsolve/plan/registry.h"

/* More than a year of the smallest flow. */
#define STEPS_MOST 1e12

static bool has_region(const struct scene *scene, enum region_type type) {
  for (size_t r = 0; r < scene->region_count; r++)
    if (scene->regions[r].type == type) return true;
  return false;
}

static bool has_moving_wall(const struct scene *scene) {
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type != REGION_WALL) continue;
    for (int a = 0; a < 3; a++)
      if (region->velocity[a] != 0) return true;
  }
  return false;
}

static bool calls_for_isph(const struct scene *scene) {
  return has_region(scene, REGION_POROUS) || has_region(scene, REGION_INFLOW);
}

int plan_wall_layers(const struct scene *scene) {
  bool isph =
      scene->method == METHOD_ISPH || (scene->method == METHOD_AUTO && calls_for_isph(scene));
  return isph ? 0 : 4;
}

static bool has_surface(const struct lattice *lattice) {
  return lattice->fluid_count + lattice->wall_count < lattice->count;
}

static double mean_spacing(const struct lattice *lattice) {
  return cbrt(lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2]);
}

/* Velocity and Reynolds number of the seepage before anything is solved. Viscous drag: Kozeny
 * (1927), Carman (1937), 5 S^2/n^3 nu v; inertia: Ergun (1952), 1.75/6 S/n^3 v^2 with S = 6 (1 -
 * n)/d, none where no wall stands across the force. S: wall surface per bulk volume; Re = v_D / (nu
 * S), Carman's, that of the mean pore. The faces of voxels overstate S by about 3/2. */
static void estimate_seepage(const struct scene *scene, const struct lattice *lattice,
                             struct effect_context *context) {
  size_t faces[3];
  double surface = 0;
  bool across = false;
  context->velocity_scale = context->reynolds = 0;
  lattice_count_faces(lattice, faces);
  for (int a = 0; a < 3; a++) {
    surface += (double)faces[a] / lattice->spacing[a];
    across = across || (faces[a] > 0 && scene->driving[a] != 0);
  }
  double s = surface / lattice->bulk_count * 2 / 3;
  double porosity = (double)lattice->fluid_count / lattice->bulk_count;
  double nu = scene->fluid.viscosity / scene->fluid.density, cube = porosity * porosity * porosity;
  double driving =
      sqrt(scene->driving[0] * scene->driving[0] + scene->driving[1] * scene->driving[1] +
           scene->driving[2] * scene->driving[2]);
  if (!(s > 0 && nu > 0)) return;
  const double viscous = 5 * s * s * nu / cube, inertial = across ? 1.75 / 6 * s / cube : 0;
  context->velocity_scale =
      2 * driving / (viscous + sqrt(viscous * viscous + 4 * inertial * driving));
  context->inertia = 1 - context->velocity_scale * viscous / fmax(driving, 1e-300);
  context->reynolds = context->velocity_scale / (nu * s);
}

/* wcsph and stokes leave walls where they are: a wall may move along itself only, as a lid does. */
static enum status refuse_displacement(const struct scene *scene) {
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    for (int a = 0; a < 3; a++)
      if (region->type == REGION_WALL && region->velocity[a] != 0 &&
          region->box[a + 3] - region->box[a] < 0.999999 * scene->domain_size[a])
        return FAIL(STATUS_INPUT,
                    "%s:%d: regions: this wall ends in %c, and moves along it; walls of this "
                    "method stay where they are: let it reach through the domain, or write method "
                    "= \"isph\"",
                    scene->path, region->line, 'x' + a);
  }
  return STATUS_OK;
}

/* What each setting allows alone, but not together. */
static enum status refuse_contradictions(const struct scene *scene, const struct lattice *lattice,
                                         enum method method) {
  bool driven = false, held = false, moves = has_moving_wall(scene);
  if (lattice->fluid_count == 0 && !has_region(scene, REGION_INFLOW))
    return scene_error(scene, *scene->model_path ? AT_MODEL : AT_REGIONS, "no site holds water; %s",
                       *scene->model_path ? "the model is all grain: look at its threshold"
                                          : "add a water region, or make it larger");
  for (int a = 0; a < 3; a++) {
    driven = driven || scene->driving[a] != 0;
    held = held || (scene->driving[a] != 0 && !scene->periodic[a]);
  }
  if (driven && !held && method == METHOD_ISPH && has_surface(lattice))
    return scene_error(scene, AT_PERIODIC,
                       "the domain repeats along the force, so water with a free surface would "
                       "fall for ever; write false for that direction, or fill the domain");
  for (size_t r = 0; r < scene->region_count; r++)
    for (int a = 0; a < 3; a++) moves = moves || scene->regions[r].velocity[a] != 0;
  if (!driven && !moves && !has_region(scene, REGION_INFLOW))
    return scene_error(scene, AT_FORCE,
                       "nothing drives a flow; give a gravity, body_acceleration or "
                       "pressure_gradient, or a region that moves");
  if (lattice->wall_count == 0 &&
      (method == METHOD_STOKES || (method == METHOD_WCSPH && !isfinite(scene->end_time))))
    return scene_error(
        scene, AT_METHOD,
        "no wall holds the fluid back, so a steady flow does not exist; add a wall%s "
        "or write method = \"wcsph\" and an end_time",
        *scene->model_path ? " (the model is all pore: look at its threshold)," : ",");
  if (scene->turbulence == SWITCH_ON && method != METHOD_ISPH)
    return scene_error(scene, AT_TURBULENCE,
                       "\"on\", but only method isph has a model of turbulence; leave it out");
  if (scene->turbulence == SWITCH_ON && !(scene->isph.smagorinsky > 0))
    return scene_error(scene, AT_TURBULENCE,
                       "\"on\", but isph.smagorinsky = 0 takes all of it away; give one of them");
  if (scene->shifting == SWITCH_ON && method == METHOD_STOKES)
    return scene_error(scene, AT_SHIFTING,
                       "\"on\", but nothing moves in method stokes; leave it out");
  static const char *const of_isph[] = {"porosity", "volume", "surface"};
  for (size_t i = 0; i < scene->output_field_count && method != METHOD_ISPH; i++)
    for (size_t k = 0; k < sizeof of_isph / sizeof *of_isph; k++)
      if (!strcmp(scene->output_fields[i], of_isph[k]))
        return scene_error(scene, AT_FIELDS, "\"%s\" is a field of method isph; leave it out",
                           of_isph[k]);
  return method == METHOD_ISPH ? STATUS_OK : refuse_displacement(scene);
}

enum status plan_method(const struct scene *scene, const struct lattice *lattice,
                        enum method *method, char why[EFFECT_WHY]) {
  struct effect_context context = {0};
  estimate_seepage(scene, lattice, &context);
  const double reynolds = context.reynolds;
  bool moving = has_moving_wall(scene);
  *method = scene->method;
  if (*method != METHOD_AUTO) {
    snprintf(why, EFFECT_WHY, "the scene says so");
  } else if (calls_for_isph(scene)) {
    *method = METHOD_ISPH;
    snprintf(why, EFFECT_WHY, "the scene holds soil or an inflow");
  } else if (has_surface(lattice)) {
    *method = METHOD_ISPH;
    snprintf(why, EFFECT_WHY, "the water has a free surface");
  } else if (lattice->wall_count == 0) {
    *method = METHOD_WCSPH;
    snprintf(why, EFFECT_WHY, "no walls: a transient flow");
  } else if (scene->steady_tolerance == 0) {
    *method = METHOD_WCSPH;
    snprintf(why, EFFECT_WHY, "a run to end_time is wanted, not the steady state");
  } else if (moving) {
    *method = METHOD_WCSPH;
    snprintf(why, EFFECT_WHY, "a wall moves");
  } else if (reynolds < 0.1) {
    *method = METHOD_STOKES;
    snprintf(why, EFFECT_WHY,
             "the flow creeps: Re = v / (nu S) about %.2g is below 0.1, and nothing moves",
             reynolds);
  } else {
    *method = METHOD_WCSPH;
    snprintf(why, EFFECT_WHY, "Re about %.2g: inertia counts", reynolds);
  }
  if (*method != METHOD_ISPH) {
    const char *name = *method == METHOD_WCSPH ? "wcsph" : "stokes";
    if (calls_for_isph(scene))
      return scene_error(scene, AT_METHOD,
                         "method %s knows no soil and no inflow; write method = \"isph\"", name);
    if (has_surface(lattice))
      return scene_error(scene, AT_METHOD,
                         "method %s needs a filled domain, but %zu of %zu sites are empty; fill "
                         "them with a water region, or write method = \"isph\"",
                         name, lattice->count - lattice->fluid_count - lattice->wall_count,
                         lattice->count);
    if (!(scene->fluid.viscosity > 0))
      return scene_error(scene, AT_VISCOSITY,
                         "method %s needs a viscosity greater than 0, like \"1e-3 Pa s\"", name);
  } else if (*scene->model_path) {
    return scene_error(scene, AT_METHOD,
                       "method isph takes a domain with regions, not a voxel model; use "
                       "method = \"wcsph\" or \"stokes\"");
  }
  return refuse_contradictions(scene, lattice, *method);
}

bool plan_has(const struct plan *plan, const char *effect_name) {
  for (size_t i = 0; i < plan->effect_count; i++)
    if (!strcmp(plan->effects[i].effect->name, effect_name)) return plan->effects[i].on;
  return false;
}

enum status plan_make(const struct scene *scene, const struct lattice *lattice, enum method method,
                      const char *method_why, int threads, struct plan *plan) {
  enum status status = STATUS_OK;
  static enum status (*const scales[])(struct plan *) = {NULL, wcsph_scales, stokes_scales,
                                                         isph_scales};
  static enum status (*const plans[])(struct plan *, int) = {NULL, wcsph_plan, stokes_plan,
                                                             isph_plan};
  *plan = (struct plan){.dt = NAN, .dt_limit = INFINITY, .expected = {NAN, NAN, ""}};
  snprintf(plan->method_why, sizeof plan->method_why, "%s", method_why);
  struct effect_context *context = &plan->context;
  context->scene = scene;
  context->lattice = lattice;
  context->method = method;
  context->spacing = lattice->dimensions == 2 ? lattice->spacing[0] : mean_spacing(lattice);
  context->kinematic_viscosity = scene->fluid.viscosity / scene->fluid.density;
  context->driving =
      sqrt(scene->driving[0] * scene->driving[0] + scene->driving[1] * scene->driving[1] +
           scene->driving[2] * scene->driving[2]);
  context->has_porous = has_region(scene, REGION_POROUS);
  context->has_inflow = has_region(scene, REGION_INFLOW);
  context->has_surface = has_surface(lattice);
  context->has_wall = lattice->wall_count > 0;
  for (int a = 0; a < 3 && method == METHOD_ISPH; a++)
    context->has_wall = context->has_wall || !scene->periodic[a];
  context->has_moving_wall = has_moving_wall(scene);
  /* Pores are resolved by wcsph and stokes only. */
  if (method != METHOD_ISPH) estimate_seepage(scene, lattice, context);
  if (method != METHOD_ISPH) pore_shape_find(scene, lattice, &plan->shape);
  TRY(scales[method](plan));
  for (size_t i = 0; i < effects_count; i++) {
    const struct effect *effect = effects_all[i];
    if (!(effect->methods & 1u << method)) continue;
    if (plan->effect_count == EFFECT_MAX) TRY_FAIL(STATUS_RUN, "more than %d effects", EFFECT_MAX);
    struct planned_effect *planned = &plan->effects[plan->effect_count++];
    planned->effect = effect;
    planned->dt_max = INFINITY;
    planned->on = effect->wanted(context, planned->why);
    if (!planned->on) continue;
    plan->fields |= effect->reads | effect->writes;
    if (effect->dt_max != NULL) planned->dt_max = effect->dt_max(context);
    if (planned->dt_max < plan->dt_limit) {
      plan->dt_limit = planned->dt_max;
      plan->dt_limited_by = effect->name;
    }
  }
  TRY(plans[method](plan, threads));
  plan->bytes_total =
      PROGRAM_BYTES + fmax(plan->bytes_method + plan->bytes_copy, plan->bytes_split);
  plan->seconds += PROGRAM_SECONDS;
  if (plan->steps > STEPS_MOST)
    TRY(scene_error(
        scene, AT_METHOD,
        "%.3g steps would be needed; a density, viscosity, force, velocity, sound speed "
        "or end_time is far off, or has a wrong unit",
        plan->steps));
cleanup:
  return status;
}
