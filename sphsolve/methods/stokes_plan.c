/* What method stokes will cost and how good it will be, before it runs. The constants were measured
 * on sand models of 60 to 240 sites a side and on the exact cases of verify_stokes. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/error_split.h"
#include "sphsolve/expectation.h"
#include "sphsolve/methods/stokes_solver.h"
#include "sphsolve/plan.h"

/* Iterations hardly depend on the size: 30 to 40 in arrays, 60 to 130 in sand; an iteration of
 * adami walls, with more of them, costs 2.2 times as much in all. */
#define ITERATIONS 70.0
#define ADAMI 2.2
/* CPU seconds per iteration: of every site, of every fluid site; and once per fluid site. */
#define SECONDS_SITE 30e-9
#define SECONDS_FLUID 140e-9
#define SECONDS_BUILD 3e-6

double stokes_solver_seconds(double sites, double active, enum wall_scheme wall) {
  const char *rows = stokes_rows_best()->name;
  const double slow = !strcmp(rows, "avx512") ? 1.0 : !strcmp(rows, "avx2") ? 1.3 : 2.5;
  return ITERATIONS * (wall == WALL_ADAMI ? ADAMI : 1.0) *
             (SECONDS_SITE * sites + SECONDS_FLUID * slow * active) +
         SECONDS_BUILD * active;
}

enum status stokes_scales(struct plan *plan) {
  struct effect_context *context = &plan->context;
  const double support = context->scene->stokes.support;
  context->support = isnan(support) ? 2.9 * context->spacing : support;
  context->smoothing_length = context->support / 3.0;
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

enum status stokes_plan(struct plan *plan, int threads) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count;
  plan->dt = 0.0;
  if (l->wall_count == 0) return STATUS_OK; /* the run says what is wrong */
  plan->bytes_total = fluid > 0.0 ? stokes_solver_bytes(sites, fluid) : 5.0 * sites;
  plan->bytes_wall = 31.0;
  plan->bytes_fluid = fluid > 0.0 ? (plan->bytes_total - 31.0 * (sites - fluid)) / fluid : 31.0;
  plan->steps = ITERATIONS;
  plan->seconds = stokes_solver_seconds(sites, fluid, plan->context.scene->stokes.wall) / threads +
                  error_split_seconds(plan->context.scene, &plan->context) / threads;
  plan->error = expect_error(&plan->shape, METHOD_STOKES, plan->context.scene->stokes.wall, 1.0,
                             plan->error_why);
  return STATUS_OK;
}
