/* Predicted cost and error of method stokes. */
#include <math.h>

#include "common/memory.h"
#include "sphsolve/geometry/percolation.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/stokes/method.h"
#include "sphsolve/stokes/constants.h"
#include "sphsolve/error/cascade.h"
#include "sphsolve/error/error_forecast.h"
#include "sphsolve/stokes/solver/cost.h"
#include "sphsolve/stokes/solver/rows.h"

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

#define MASK_BYTES 2.0  /* per row: a mask for each sixteen sites */
#define FLOOD_FLUID 4.0 /* per fluid site, during the percolation search */
#define RUN_BYTES 200e3 /* records of the run, whatever the size */

/* Size of the scene's lattice resampled to a given spacing (m), mirrored if requested. */
struct sites {
  double count, fluid, stride, rows; /* stride: row length in whole vectors */
};

static struct sites sites_at(const struct plan *plan, double spacing, bool mirrored) {
  const struct lattice *l = plan->context.lattice;
  const bool *unlike = l->model.unlike;
  size_t size[3], count;
  double n[3] = {0};
  if (lattice_resampled_size(l, spacing, size, &count) != STATUS_OK) {
    error_clear(); /* too many sites: the run itself reports it */
    return (struct sites){0};
  }
  for (int a = 0; a < 3; a++) n[a] = (double)size[a] * (mirrored && unlike[a] ? 2.0 : 1.0);
  const double all = n[0] * n[1] * n[2];
  return (struct sites){.count = all,
                        .fluid = all * (double)l->fluid_count / (double)l->count,
                        .stride = STOKES_LANES * ceil(n[0] / STOKES_LANES),
                        .rows = n[1] * n[2]};
}

/* Bytes of a solver without its lattice. */
static double solver_bytes(const struct plan *plan, const struct sites *s) {
  const bool soil = plan->context.lattice->micro_porosity != NULL;
  const double whole = COARSER_BYTES * s->count, lattice = soil ? SOIL_BYTES : 0.0;
  const double divided = stokes_solver_bytes(s->count, s->fluid, soil) - whole -
                         (LATTICE_BYTES + lattice) * s->count +
                         FIELD_BYTES * (s->stride * s->rows - s->count);
  return divided + whole + SOLVER_BYTES;
}

static double rows_bytes(const struct sites *s) {
  return (ROW_BYTES + MASK_BYTES * s->stride / STOKES_LANES) * s->rows;
}

/* Bytes while the mirrored lattice is solved at the given spacing (m) for the error of the sides:
 * beside it stand the second lattice of the cascade and the solution of the first. 0 if no such
 * lattice is solved. */
static double sides_bytes(const struct plan *plan, double spacing) {
  const struct lattice *l = plan->context.lattice;
  const double base_spacing = plan->context.spacing;
  const double site = LATTICE_BYTES + (l->micro_porosity != NULL ? SOIL_BYTES : 0.0);
  if (!(cascade_sides_sites(plan) > 0.0)) return 0.0;
  const struct sites first = sites_at(plan, cascade_fixed_ratios[0] * base_spacing, false);
  const struct sites second = sites_at(plan, cascade_fixed_ratios[1] * base_spacing, false);
  const struct sites wrapped = sites_at(plan, spacing, false);
  const struct sites sides = sites_at(plan, spacing, true);
  const double lattices = site * ((double)l->count + second.count + wrapped.count + sides.count);
  return RUN_BYTES + lattices + rows_bytes(&second) + rows_bytes(&sides) +
         SOLUTION_BYTES * first.fluid + solver_bytes(plan, &second) +
         fmax(FLOOD_SITE * sides.count + FLOOD_FLUID * sides.fluid, solver_bytes(plan, &sides));
}

double stokes_sides_finer_bytes(const struct plan *plan) {
  const struct lattice *l = plan->context.lattice;
  const double usual = cascade_sides_spacing(plan, l);
  double spacing = usual, sites;
  if (!(cascade_sides_sites(plan) > 0.0)) return 0.0;
  while (cascade_sides_finer(l, &spacing, &sites)) continue;
  return spacing < usual ? sides_bytes(plan, spacing) : 0.0;
}

enum status stokes_cost(struct plan *plan, int threads) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count;
  plan->dt = 0.0;
  if (l->wall_count == 0 && l->micro_porosity == NULL)
    return STATUS_OK; /* the run itself reports the error */
  const bool soil = l->micro_porosity != NULL;
  plan->bytes_method = fluid > 0.0 ? stokes_solver_bytes(sites, fluid, soil) : KIND_BYTES * sites;
  plan->bytes_method = fmax(plan->bytes_method, sides_bytes(plan, cascade_sides_spacing(plan, l)));
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
