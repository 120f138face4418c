/* What method stokes will cost and how good it will be, before it runs. */
#include <math.h>
#include <stdio.h>

#include "sphsolve/plan.h"

/* Sites a pore is wide on the average: 4 V / S, S the voxel faces less their excess of 3/2. */
static double pore_width(const struct lattice *l) {
  const size_t step[3] = {1, l->size[0], l->size[0] * l->size[1]};
  double faces = 0.0;
  for (size_t site = 0; site < l->count; site++)
    for (int a = 0; a < 3; a++) {
      const bool last = site / step[a] % l->size[a] + 1 == l->size[a];
      const size_t next = last ? site - (l->size[a] - 1) * step[a] : site + step[a];
      faces += l->kind[site] != l->kind[next];
    }
  return faces > 0.0 ? 4.0 * (double)l->fluid_count / (faces * 2.0 / 3.0) : INFINITY;
}

enum status stokes_scales(struct plan *plan) {
  struct effect_context *context = &plan->context;
  const double support = context->scene->stokes.support;
  context->support = isnan(support) ? 2.9 * context->spacing : support;
  context->smoothing_length = context->support / 3.0;
  return STATUS_OK;
}

enum status stokes_plan(struct plan *plan, int threads) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count;
  const double width = pore_width(l);
  plan->dt = 0.0;
  /* wall and fluid sites: the lattice, the unpacked fields; fluid sites: matrix, vectors, basis */
  plan->bytes_wall = 5.0 + 16.0;
  plan->bytes_fluid = plan->bytes_wall + 32.0 + 16.0 * (2.0 + 1.0 + 31.0 + 1.0);
  plan->bytes_total = plan->bytes_wall * (sites - fluid) + plan->bytes_fluid * fluid;
  plan->steps = 200.0;
  plan->seconds = plan->steps * (40e-9 * sites + 60e-9 * fluid) / threads + 1e-6 * sites / threads;
  plan->error = fmin(1.0, 1.5 / (width * width));
  snprintf(plan->error_why, EFFECT_WHY, "pores are %.1f spacings wide on the average", width);
  return STATUS_OK;
}
