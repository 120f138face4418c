/* What method stokes will cost and how good it will be, before it runs. The constants were measured
 * on sand models of 60 to 240 sites a side and on the exact cases of verify_stokes. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/stokes/method.h"
#include "sphsolve/stokes/cascade.h"
#include "sphsolve/plan/error_forecast.h"
#include "sphsolve/stokes/solver.h"

/* Iterations until k is within e of its limit, from any size of lattice: 21 to 1e-3, 31 to 1e-4;
 * half as many between straight walls. With Adami walls 1.8 times as many. k is wrong by the square
 * of the residual. */
#define ITERATIONS_DECADE 9.5
#define ITERATIONS_FIRST -7.0
#define STRAIGHT 0.5
#define ADAMI 1.8
/* CPU seconds per iteration: of every site, of every fluid site; and once per fluid site. */
#define SECONDS_SITE 30e-9
#define SECONDS_FLUID 140e-9
#define SECONDS_BUILD 1e-6

static double iterations(const struct pore_shape *pores, const struct stokes_goal *goal,
                         enum wall_scheme wall) {
  const double least = goal->residual > 0.0 ? goal->residual * goal->residual : goal->mean;
  const double count = fmax(ITERATIONS_FIRST - ITERATIONS_DECADE * log10(least), 3.0);
  return count * (pores->straight ? STRAIGHT : 1.0) * (wall == WALL_ADAMI ? ADAMI : 1.0);
}

double stokes_seconds(double iterations, double sites, double fluid) {
  const char *rows = stokes_rows_best()->name;
  const double slow = !strcmp(rows, "avx512") ? 1.0 : !strcmp(rows, "avx2") ? 1.3 : 2.5;
  return iterations * (SECONDS_SITE * sites + SECONDS_FLUID * slow * fluid) + SECONDS_BUILD * fluid;
}

double stokes_solver_seconds(const struct pore_shape *pores, const struct lattice *l,
                             double refined, const struct stokes_goal *goal,
                             enum wall_scheme wall) {
  const double more = pow(refined, l->dimensions);
  return stokes_seconds(iterations(pores, goal, wall), more * (double)l->count,
                        more * (double)l->fluid_count);
}

enum status stokes_scales(struct plan *plan) {
  struct effect_context *context = &plan->context;
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

enum status stokes_cost(struct plan *plan, int threads) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count;
  plan->dt = 0.0;
  if (l->wall_count == 0) return STATUS_OK; /* the run says what is wrong */
  plan->bytes_method = fluid > 0.0 ? stokes_solver_bytes(sites, fluid) : 5.0 * sites;
  plan->bytes_method = fmax(plan->bytes_method, stokes_sides_bytes(plan, 1.0, 0.0));
  plan->bytes_wall = 31.0;
  plan->bytes_fluid = fluid > 0.0 ? (plan->bytes_method - 31.0 * (sites - fluid)) / fluid : 31.0;
  const enum wall_scheme wall = plan->context.scene->stokes.wall;
  const struct stokes_goal goal = stokes_goal_of(plan->context.scene);
  plan->steps = round(iterations(&plan->shape, &goal, wall));
  plan->seconds = (stokes_solver_seconds(&plan->shape, l, 1.0, &goal, wall) +
                   cascade_seconds(plan->context.scene, plan, false)) /
                  threads;
  plan->expected = error_forecast_of(&plan->shape, &method_stokes, wall, 1.0);
  return STATUS_OK;
}
