/* What method stokes will cost and how good it will be, before it runs. The constants were measured
 * on sand models of 60 to 240 sites a side and on the exact cases of verify_stokes. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/methods/stokes_solver.h"
#include "sphsolve/plan.h"

/* Iterations hardly depend on the model: 40 to 60. */
#define ITERATIONS 50.0
/* CPU seconds per iteration: of every site, of every fluid site; and once per fluid site. */
#define SECONDS_SITE 30e-9
#define SECONDS_FLUID 140e-9
#define SECONDS_BUILD 3e-6

/* Sites a pore is wide on the average: 4 V / S, S the voxel faces less their excess of 3/2. Also
 * the share of the sites next to a wall that lie half a spacing from it, as with voxel faces. */
static double pore_width(const struct lattice *l, double *on_faces) {
  const size_t step[3] = {1, l->size[0], l->size[0] * l->size[1]};
  double faces = 0.0, half = 0.0;
  for (size_t site = 0; site < l->count; site++)
    for (int a = 0; a < 3; a++) {
      const bool last = site / step[a] % l->size[a] + 1 == l->size[a];
      const size_t next = last ? site - (l->size[a] - 1) * step[a] : site + step[a];
      if (l->kind[site] == l->kind[next]) continue;
      const size_t fluid = l->kind[site] == SITE_FLUID ? site : next;
      faces += 1.0;
      half += fabs(l->wall_distance[fluid] / l->spacing[a] - 0.5) < 1e-3;
    }
  *on_faces = faces > 0.0 ? half / faces : 0.0;
  return faces > 0.0 ? 4.0 * (double)l->fluid_count / (faces * 2.0 / 3.0) : INFINITY;
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

/* Error of k from the mean width w of the pores in sites. */
static void expect_error(struct plan *plan, double width, double on_faces) {
  const struct scene *scene = plan->context.scene;
  const char *why = "walls from the wall distance: second order";
  plan->error = fmin(1.0, 20.0 / (width * width));
  if (scene->stokes.wall == WALL_FROZEN) {
    plan->error = fmin(5.0, 8.0 / width);
    why = "frozen walls: every gap a site too wide";
  } else if (!*scene->model_path) {
    plan->error = 1.0 / (width * width);
    why = "straight walls: second order";
  } else if (on_faces > 0.9) {
    plan->error = fmin(1.0, 3.0 / width);
    why = "walls are voxel faces, full of edges: first order";
  }
  snprintf(plan->error_why, EFFECT_WHY, "pores %.1f sites wide on the average; %s", width, why);
}

enum status stokes_plan(struct plan *plan, int threads) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count;
  const char *rows = stokes_rows_best()->name;
  const double slow = !strcmp(rows, "avx512") ? 1.0 : !strcmp(rows, "avx2") ? 1.3 : 2.5;
  double on_faces = 0.0;
  plan->dt = 0.0;
  if (l->wall_count == 0) return STATUS_OK; /* the run says what is wrong */
  const double width = pore_width(l, &on_faces);
  plan->bytes_total = fluid > 0.0 ? stokes_solver_bytes(sites, fluid) : 5.0 * sites;
  plan->bytes_wall = 31.0;
  plan->bytes_fluid = fluid > 0.0 ? (plan->bytes_total - 31.0 * (sites - fluid)) / fluid : 31.0;
  plan->steps = ITERATIONS;
  plan->seconds = ITERATIONS * (SECONDS_SITE * sites + SECONDS_FLUID * slow * fluid) / threads +
                  SECONDS_BUILD * fluid / threads;
  expect_error(plan, width, on_faces);
  return STATUS_OK;
}
