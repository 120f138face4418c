/* Predicted cost and error of method stokes. */
#include <math.h>

#include "common/memory.h"
#include "sphsolve/geometry/percolation.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/stokes/method.h"
#include "sphsolve/stokes/constants.h"
#include "sphsolve/stokes/cascade/cascade.h"
#include "sphsolve/plan/error_forecast.h"
#include "sphsolve/stokes/solver/cost.h"

enum status stokes_scales(struct plan *plan) {
  struct effect_context *context = &plan->context;
  if (context->lattice->micro_porosity != NULL && context->scene->stokes.wall == WALL_ADAMI)
    return scene_error(
        context->scene, AT_METHOD,
        "stokes.wall = \"adami\" knows no soil with pores below the voxel, which the "
        "model has; leave it out");
  const int factors = context->scene->micro.factor_count;
  if (factors > 0 && context->lattice->micro_porosity != NULL) {
    const double factor = context->scene->micro.factors[factors - 1];
    const double most = lattice_soil_most(context->lattice), voxel = context->spacing;
    if (factor * most > voxel * voxel)
      return scene_error(context->scene, AT_MICRO_FACTORS,
                         "%g times the permeability of the soil, at most %.3g m^2, is above the "
                         "square of a voxel, %.3g m^2; %.3g is the largest factor",
                         factor, most, voxel * voxel, voxel * voxel / most);
  }
  context->kernel = context->scene->stokes.kernel;
  context->support = stokes_support(context->scene, context->spacing) * context->spacing;
  context->smoothing_length =
      context->support / kernel_support_ratio(context->scene->stokes.kernel);
  for (int a = 0; a < 3; a++) {
    const double spacings = context->support / context->lattice->spacing[a];
    if (context->lattice->dimensions == 2 && a == 1) continue;
    if (!(spacings >= 1.5 && spacings < STOKES_REACH + 1))
      return scene_error(context->scene, AT_STOKES_SUPPORT,
                         "%g m is %.2f spacings along %c; choose one between 1.5 and %d",
                         context->support, spacings, "xyz"[a], STOKES_REACH);
  }
  return STATUS_OK;
}

enum status stokes_bytes_least(const struct plan *plan, double *bytes) {
  enum status status = STATUS_OK;
  const struct lattice *l = plan->context.lattice;
  uint8_t *flowing = NULL;
  size_t active = 0;
  bool flows;
  *bytes = 0.0;
  TRY(memory_allocate(&flowing, l->count, 1, "labels of the pores"));
  TRY(percolation_find(l, plan->context.scene->driving, false, flowing, &flows));
  for (size_t s = 0; s < l->count; s++) active += flowing[s] == PERCOLATION_FLOWS;
  if (active > 0)
    *bytes = BYTES_LOWER_BOUND *
             stokes_solver_bytes((double)l->count, (double)active, l->micro_porosity != NULL);
cleanup:
  memory_free(&flowing);
  return status;
}

/* Wall distances of the model's own sites, kept beside a lattice of another spacing. */
static double surface_bytes(const struct lattice *l) {
  return l->own_surface ? sizeof(float) * (double)l->own_surface->count : 0.0;
}

enum status stokes_cost(struct plan *plan, int threads) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count;
  plan->dt = 0.0;
  if (l->wall_count == 0 && l->micro_porosity == NULL)
    return STATUS_OK; /* the run itself reports the error */
  const bool soil = l->micro_porosity != NULL;
  plan->bytes_method = fluid > 0.0 ? stokes_solver_bytes(sites, fluid, soil) : KIND_BYTES * sites;
  plan->bytes_method = fmax(plan->bytes_method, stokes_sides_bytes(plan, 1.0));
  plan->bytes_method += surface_bytes(l);
  plan->bytes_wall = stokes_solver_bytes(1.0, 0.0, soil);
  plan->bytes_fluid = fluid > 0.0
                          ? (plan->bytes_method - plan->bytes_wall * (sites - fluid)) / fluid
                          : plan->bytes_wall;
  const enum wall_scheme wall = plan->context.scene->stokes.wall;
  const struct stokes_goal goal = stokes_goal_of(plan->context.scene);
  plan->steps = round(stokes_iterations(&plan->shape, &goal, wall));
  const double curve = 1.0 + plan->context.scene->micro.factor_count;
  plan->seconds = (curve * stokes_solver_seconds(&plan->shape, l, 1.0, &goal, wall) +
                   cascade_seconds(plan->context.scene, plan, false)) /
                  threads;
  plan->bytes_sides = stokes_sides_finer_bytes(plan);
  plan->seconds_sides = cascade_sides_finer_seconds(plan, false) / threads;
  plan->expected = error_forecast_of(&plan->shape, &method_stokes, wall, 1.0);
  return STATUS_OK;
}
