#include "sphsolve/plan/plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "common/units.h"
#include "sphsolve/geometry/percolation.h"
#include "sphsolve/plan/constants.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/plan/reynolds.h"

/* No real run takes this many steps: the scene has a wrong number or unit. */
#define STEPS_MAX 1e12

static bool has_moving_wall(const struct scene *scene) {
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type != REGION_WALL) continue;
    for (int a = 0; a < 3; a++)
      if (region->velocity[a] != 0) return true;
  }
  return false;
}

static double mean_spacing(const struct lattice *lattice) {
  return cbrt(lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2]);
}

/* Estimates velocity and Reynolds number of the seepage before anything is solved. Viscous drag:
 * Kozeny (1927), Carman (1937), 5 S^2/n^3 nu v; inertia: Ergun (1952), 1.75/6 S/n^3 v^2 with S = 6
 * (1 - n)/d, or none if no wall stands across the force. S: wall surface per bulk volume; the faces
 * of voxels overestimate it by about 3/2. */
void plan_estimate_seepage(struct effect_context *context) {
  const struct scene *scene = context->scene;
  const struct lattice *lattice = context->lattice;
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
  const double driving = context->driving;
  if (!(s > 0 && nu > 0)) return;
  const double viscous = 5 * s * s * nu / cube,
               inertial = across ? ERGUN_INERTIAL / 6 * s / cube : 0;
  context->velocity_scale =
      2 * driving / (viscous + sqrt(viscous * viscous + 4 * inertial * driving));
  context->inertia = 1 - context->velocity_scale * viscous / fmax(driving, 1e-300);
  const double darcy[3] = {context->velocity_scale, 0, 0};
  context->reynolds = reynolds_number(darcy, porosity, hydraulic_diameter(lattice), nu);
}

void plan_context(const struct scene *scene, const struct lattice *lattice,
                  struct effect_context *context) {
  const double *f = scene->driving;
  *context = (struct effect_context){.scene = scene,
                                     .lattice = lattice,
                                     .driving = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]),
                                     .has_porous = scene_has_region(scene, REGION_POROUS),
                                     .has_inflow = scene_has_region(scene, REGION_INFLOW),
                                     .has_rain = scene_has_region(scene, REGION_RAIN),
                                     .has_absorbing = scene_has_region(scene, REGION_ABSORBING),
                                     .has_moving_wall = has_moving_wall(scene)};
  if (lattice == NULL) return;
  context->has_surface = lattice->fluid_count + lattice->wall_count < lattice->count;
  context->has_wall = lattice->wall_count > 0;
}

enum status plan_find_path(struct plan *plan) {
  const struct effect_context *c = &plan->context;
  const bool corners = c->method->joins_corners != NULL && c->method->joins_corners(c);
  bool flows = true;
  if (!c->method->resolves_pores || !(c->driving > 0)) return STATUS_OK;
  const enum status status = percolation_find(c->lattice, c->scene->driving, corners, NULL, &flows);
  plan->blocked = !flows;
  if (flows) return status;
  plan->steps = plan->seconds = plan->seconds_sides = plan->expected_scan = NAN;
  plan->bytes_sides = plan->expected_threshold = 0.0;
  plan->expected = (struct error_forecast){.error = NAN, .least = NAN};
  snprintf(plan->expected.why, sizeof plan->expected.why, "%s", percolation_none(c->lattice));
  return status;
}

uint32_t plan_budget(const struct plan *plan) {
  uint32_t terms = 0;
  for (size_t i = 0; i < plan->effect_count; i++)
    if (plan->effects[i].on) terms |= plan->effects[i].effect->budget;
  return terms;
}

void plan_switch(const struct plan *plan, void *settings) {
  for (size_t i = 0; i < plan->effect_count; i++) {
    const struct effect *effect = plan->effects[i].effect;
    if (effect->switches_on > 0)
      *(bool *)((char *)settings + (effect->switches_on - 1)) = plan->effects[i].on;
  }
}

static double add_program_bytes(double bytes) {
  return PROGRAM_BYTES + (1.0 + MEMORY_OVERHEAD) * bytes;
}

enum status plan_make(const struct scene *scene, const struct lattice *lattice,
                      const struct method *method, const char *method_why, int threads,
                      struct plan *plan) {
  enum status status = STATUS_OK;
  *plan = (struct plan){.threads = threads,
                        .dt = NAN,
                        .dt_limit = INFINITY,
                        .expected = {.error = NAN, .least = NAN},
                        .expected_scan = NAN};
  snprintf(plan->method_why, sizeof plan->method_why, "%s", method_why);
  struct effect_context *context = &plan->context;
  plan_context(scene, lattice, context);
  context->method = method;
  context->spacing = lattice->dimensions == 2 ? lattice->spacing[0] : mean_spacing(lattice);
  context->kinematic_viscosity = scene->fluid.viscosity / scene->fluid.density;
  /* Closed sides are walls also for a method that needs no wall sites. */
  for (int a = 0; a < 3 && method->wall_layers == 0; a++)
    context->has_wall = context->has_wall || !scene->periodic[a];
  if (method->resolves_pores) {
    plan_estimate_seepage(context);
    TRY(method->expect(plan));
  }
  TRY(method->scales(plan));
  for (size_t i = 0; method->effects[i] != NULL; i++) {
    const struct effect *effect = method->effects[i];
    if (plan->effect_count == EFFECT_MAX) TRY_FAIL(STATUS_RUN, "more than %d effects", EFFECT_MAX);
    struct planned_effect *planned = &plan->effects[plan->effect_count++];
    planned->effect = effect;
    planned->dt_max = INFINITY;
    planned->on = effect->wanted(context, planned->why);
    if (!planned->on) continue;
    if (effect->dt_max != NULL) planned->dt_max = effect->dt_max(context);
    if (planned->dt_max < plan->dt_limit) {
      plan->dt_limit = planned->dt_max;
      plan->dt_limited_by = effect->name;
    }
  }
  TRY(method->cost(plan, threads));
  plan->bytes_total =
      add_program_bytes(fmax(fmax(plan->bytes_method + plan->bytes_copy, plan->bytes_split),
                             MODEL_BYTES * (double)lattice->model.count));
  plan->bytes_sides = add_program_bytes(plan->bytes_sides);
  if (!(plan->bytes_sides > plan->bytes_total)) plan->bytes_sides = 0.0;
  plan->seconds += PROGRAM_SECONDS;
  if (plan->steps > STEPS_MAX)
    TRY(scene_error(
        scene, AT_METHOD,
        "%.3g steps would be needed; a density, viscosity, force, velocity, sound speed "
        "or end_time is far off, or has a wrong unit",
        plan->steps));
  if (plan->seconds > SECONDS_MAX) {
    char time[40];
    duration_format(plan->seconds, time, sizeof time);
    log_warning("%s: this run will take about %s; a larger spacing or an earlier end makes it "
                "shorter",
                scene->path, time);
  }
cleanup:
  return status;
}
