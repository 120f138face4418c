/* Forecast of the cost of method isph: memory, steps, time, and the error of k. */
#include "common/log.h"
#include "sphsolve/isph/fields.h"
#include "sphsolve/isph/method.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/isph/speed_forecast.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/isph/threads.h"
#include "sphsolve/isph/switches.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/constants.h"

enum status isph_scales(struct plan *plan) {
  struct effect_context *context = &plan->context;
  const struct scene *scene = context->scene;
  context->kernel = scene->isph.kernel;
  context->support = scene->isph.support_ratio * context->spacing;
  context->smoothing_length = context->support / kernel_support_ratio(scene->isph.kernel);
  return isph_reynolds_predict(context, &context->surface_reynolds);
}

/* Number of steps as isph_stable_dt will choose them, while the water is fast and after that. */
static double steps_at(const struct plan *plan, const struct isph_speed_forecast *speeds,
                       double dt_limit) {
  const struct effect_context *context = &plan->context;
  const double dx = context->spacing, time = context->scene->end_time;
  const double driving = fmax(context->driving, isph_head_drive(context->scene));
  const double force = driving > 0 ? 0.25 * sqrt(dx / driving) : INFINITY;
  const double least = fmin(fmin(force, dt_limit), time / 2);
  if (!(least > 0)) return INFINITY; /* a force that is not finite */
  const double displacement = (context->has_surface ? DT_ADVECTION_SURFACE : DT_ADVECTION) * dx;
  const double fast = fmin(time, speeds->lasts);
  return fast / fmin(least, displacement / speeds->speed) +
         (time - fast) / fmin(least, displacement / speeds->speed_after);
}

/* The next larger number of two digits; that number itself if x is one. */
static double rounded_up(double x) {
  const double unit = pow(10, floor(log10(x)) - 1);
  return ceil(x / unit - 1e-6) * unit;
}

/* Refuses a run of more than HOPELESS_STEPS steps that takes HOPELESS_RATIO times as many as it
 * would without what shortens them: a given dt, or the explicit viscosity, as in 10 cm of tar. */
static enum status check_steps(const struct plan *plan, const struct isph_speed_forecast *speeds) {
  const struct effect_context *context = &plan->context;
  const bool given = !isnan(plan->dt);
  const double viscous =
      DT_VISCOSITY * context->spacing * context->spacing / context->kinematic_viscosity;
  const double usual = steps_at(plan, speeds, given ? plan->dt_limit : INFINITY);
  const double ratio = plan->steps / usual / HOPELESS_RATIO;
  if (!(plan->steps > HOPELESS_STEPS && ratio > 1)) return STATUS_OK;
  const double excess = plan->steps / HOPELESS_STEPS, most = fmin(ratio, excess);
  if (given)
    return scene_error(context->scene, AT_ISPH_DT,
                       "%g s asks for %.2g steps, where dt = \"auto\" takes some %.3g; write that, "
                       "or a dt of at least %.2g s",
                       plan->dt, plan->steps, usual, rounded_up(plan->dt * most));
  if (!(viscous <= plan->dt_limit)) return STATUS_OK;
  return scene_error(context->scene, AT_VISCOSITY,
                     "this viscosity allows no step above %g s, %g spacing^2/nu, and asks for %.2g "
                     "steps; take a viscosity below %.2g Pa s, or a domain.spacing above %.2g m",
                     plan->dt_limit, DT_VISCOSITY, plan->steps,
                     context->scene->fluid.viscosity / most,
                     context->spacing * fmin(cbrt(ratio * ratio), sqrt(excess)));
}

/* Length of the soil along the flow axis, in spacings of the particles in it. Soil that spans the
 * domain along that axis has no ends there: water comes in and goes out through its other faces. */
static double soil_length(const struct effect_context *context, const struct region *region,
                          int axis) {
  const double *size = context->scene->domain_size;
  const int dimensions = context->lattice->dimensions;
  double way = region->extent[axis + 3] - region->extent[axis];
  if (way > SPANS * size[axis])
    for (int a = 0; a < 3; a++) {
      const double length = region->extent[a + 3] - region->extent[a];
      if ((dimensions == 3 || a != 1) && length < SPANS * size[a]) way = fmin(way, length);
    }
  return way / (context->spacing * pow(region->porosity, -1.0 / dimensions));
}

/* Expected error of soil whose thinnest layer is `thinnest` of its own particles thick, and the
 * spacing that would suffice. */
static void expect_layer_ends(struct error_forecast *e, double thinnest, double spacing) {
  e->error = e->least = LAYER_END_ERROR / thinnest;
  int n = snprintf(e->why, sizeof e->why,
                   "the ends of soil %.3g particles of its own long are known to %g of one",
                   thinnest, LAYER_END_ERROR);
  if (e->error > ACCEPTED_ERROR)
    snprintf(e->why + n, sizeof e->why - (size_t)n, "; domain.spacing = \"%.2g mm\" for %g %%",
             1e3 * spacing * ACCEPTED_ERROR / e->error, 100 * ACCEPTED_ERROR);
}

/* Expected error of the flow between two heads, of which drag is implicit and exact in uniform
 * soil, so that only the ends of layers count. For other scenes no estimate is known. */
static void expect_isph(struct plan *plan) {
  const struct scene *scene = plan->context.scene;
  struct error_forecast *e = &plan->expected;
  double thinnest = INFINITY;
  int heads = 0, axis = 0;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type != REGION_INFLOW || region->boundary != BOUNDARY_HEAD) continue;
    heads++;
    for (int a = 0; a < 3; a++)
      if (!(plan->context.lattice->dimensions == 2 && a == 1) &&
          region->box[a + 3] - region->box[a] < region->box[axis + 3] - region->box[axis])
        axis = a;
  }
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type != REGION_POROUS) continue;
    thinnest = fmin(thinnest, soil_length(&plan->context, region, axis));
  }
  if (heads == 2 && isfinite(thinnest)) {
    expect_layer_ends(e, thinnest, plan->context.spacing);
    return;
  }
  const double porosity = isph_soil_minimum(scene), dx = 1e3 * plan->context.spacing;
  int n =
      snprintf(e->why, sizeof e->why,
               "no k is asked for; fronts and surfaces are good to about a particle, %.3g mm", dx);
  if (isfinite(thinnest))
    snprintf(e->why + n, sizeof e->why - (size_t)n, ", in soil of porosity %g %.3g mm", porosity,
             dx * pow(porosity, -1.0 / plan->context.lattice->dimensions));
}

/* Warns if water will enter such soil. */
static void warn_of_fronts(const struct effect_context *context) {
  const struct lattice *l = context->lattice;
  const struct region *regions = context->scene->regions;
  for (size_t p = 0; p < l->count && l->region != NULL; p++) {
    if (l->kind[p] != SITE_EMPTY || l->region[p] == 0) continue;
    const struct region *soil = &regions[l->region[p] - 1];
    if (soil->type != REGION_POROUS || !(soil->porosity < FRONT_POROSITY)) continue;
    log_warning("%s:%d: fronts of water in dry soil of porosity %g come early or late by up to a "
                "fifth, at any spacing; from a porosity of %g on by some 5 %%",
                context->scene->path, soil->line, soil->porosity, FRONT_POROSITY);
    return;
  }
}

/* Bytes of a particle beside its fields and its pairs: the levels of the multigrid. */
#define REST_BYTES 60

/* Memory of a particle, by the tables of its fields and of its pairs. */
static enum status find_bytes(struct plan *plan, double neighbours) {
  const struct effect_context *context = &plan->context;
  struct isph s = {.scene = context->scene, .dimensions = context->lattice->dimensions};
  struct isph_kept kept;
  const enum status status = isph_switches_of(plan, &s.on);
  if (status != STATUS_OK) return status;
  for (int a = 0; a < 3; a++)
    s.force[a] = isph_scene_uses_axis(context, a) ? context->scene->driving[a] : 0;
  isph_fields_kept(&s, &kept);
  /* see struct isph_chunk */
  const size_t numbers = s.on.links ? 5 : 3;
  const double pair = (double)(numbers * sizeof(float));
  const double chunk = (double)(sizeof(struct isph_chunk) + sizeof *s.sums);
  plan->bytes_fluid =
      (double)isph_fields_bytes(&s) + chunk / CHUNK + REST_BYTES + PAIRS_ROOM * neighbours * pair;
  plan->bytes_copy = (double)context->lattice->fluid_count * (double)kept.bytes;
  return STATUS_OK;
}

enum status isph_cost(struct plan *plan, int threads) {
  const struct effect_context *context = &plan->context;
  const struct scene *scene = context->scene;
  double n = (double)context->lattice->fluid_count;
  enum status status = isph_refuse(context);
  if (status != STATUS_OK) return status;
  warn_of_fronts(context);
  double neighbours = isph_neighbours(scene);
  /* Time in which water that starts at rest falls half a spacing. */
  double fall = sqrt(context->spacing / context->driving);
  if (!isnan(scene->isph.dt) && scene->isph.dt > fall)
    return scene_error(scene, AT_ISPH_DT,
                       "%g s is beyond the limit of %g s, sqrt(spacing / acceleration); use dt = "
                       "\"auto\"",
                       scene->isph.dt, fall);
  if (!isnan(scene->isph.dt) && scene->isph.dt > plan->dt_limit)
    return scene_error(scene, AT_ISPH_DT,
                       "%g s is beyond the limit of %g s that %s sets; use dt = \"auto\"",
                       scene->isph.dt, plan->dt_limit, plan->dt_limited_by);
  plan->dt = scene->isph.dt; /* NAN: chosen in each step */
  status = find_bytes(plan, neighbours);
  if (status != STATUS_OK) return status;
  plan->bytes_wall = 0;
  plan->bytes_method = n * plan->bytes_fluid;
  struct isph_speed_forecast speeds;
  status = isph_speed_predict(context, &speeds);
  if (status != STATUS_OK) return status;
  plan->steps =
      isnan(plan->dt) ? steps_at(plan, &speeds, plan->dt_limit) : scene->end_time / plan->dt;
  plan->steps = isfinite(scene->end_time) ? ceil(plan->steps) : NAN;
  status = check_steps(plan, &speeds);
  if (status != STATUS_OK) return status;
  plan->seconds = plan->steps * n * (context->lattice->dimensions == 2 ? SECONDS_2D : SECONDS_3D) /
                  isph_threads(scene, n, threads < 8 ? threads : 8);
  expect_isph(plan);
  return STATUS_OK;
}
