/* Memory of method isph on several ranks (docs/scaling.md). */
#include "sphsolve/isph/method.h"
#include "sphsolve/isph/constants.h"

#include <math.h>

#define GRID_BYTES 40.0 /* bytes on every rank: of the grid, per particle, */

/* Number of particles in the walls around the domain. */
static double walls_around(const struct plan *plan) {
  const struct lattice *l = plan->context.lattice;
  const double layers = ceil(plan->context.scene->isph.support_ratio);
  double inner = 1, outer = 1;
  for (int a = 0; a < 3; a++) {
    const bool closed = !plan->context.scene->periodic[a] && !(l->dimensions == 2 && a == 1);
    inner *= (double)l->size[a];
    outer *= (double)l->size[a] + (closed ? 2 * layers : 0);
  }
  return outer - inner;
}

void isph_ranks_memory(const struct plan *plan, int ranks, int threads,
                       struct ranks_memory *memory) {
  (void)threads;
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count, r = ranks;
  const double layers = RANKS_GHOST_LAYERS * plan->context.scene->isph.support_ratio;
  const double surface = pow(fluid, l->dimensions == 2 ? 1.0 / 2 : 2.0 / 3);
  const double beside = fmin(layers * surface * fmin(2, r - 1), fluid - fluid / r); /* slabs */
  memory->whole =
      GRID_BYTES * fluid + RANKS_SITE_BYTES * sites + RANKS_WALL_BYTES * walls_around(plan);
  memory->held = RANKS_GHOST_BYTES * beside;
}
