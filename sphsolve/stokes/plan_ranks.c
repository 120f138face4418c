/* What method stokes costs on several ranks (docs/scaling.md). */
#include "sphsolve/stokes/method.h"

#include <math.h>

/* Per iteration; slabs are at least four planes. */
#define SLAB_LEAST 4.0
#define COARSE_SECONDS 1.4e-9 /* a site: levels that every rank solves */
#define GATHERINGS 4.0
#define MESSAGES 69.0
#define SUMS 3.8

void stokes_ranks_cost(const struct plan *plan, int ranks, int threads, struct ranks_cost *cost) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, planes = (double)l->size[2];
  const double nx = (double)l->size[0], ny = (double)l->size[1];
  const double r = fmin(ranks, fmax(1, floor(planes / SLAB_LEAST)));
  cost->used = r;
  cost->uneven = ceil(fmax(1, planes / SLAB_LEAST) / r) * r / fmax(1, planes / SLAB_LEAST);
  cost->in_full = plan->steps * COARSE_SECONDS * sites * (1 - 1 / r) / threads;
  cost->gathered = (1 - 1 / r) * sites * GATHERINGS / 64 * sizeof(float);
  cost->ghosts = 176 * 16 * ceil(nx / 16) * ny + 32 * nx * ny;
  cost->held = r > 1 ? cost->ghosts : 0; /* each has its place */
  cost->messages = MESSAGES;
  cost->sums = SUMS;
  cost->shares_sites = true;
}
