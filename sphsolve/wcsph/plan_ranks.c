/* Memory of method wcsph on several ranks (docs/scaling.md). */
#include <math.h>

#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/plan.h"

/* Number of sites within `reach` of a rank's part, limited to all others: the lattice is bisected
 * repeatedly across its longest side. */
static double count_ghost_sites(const struct lattice *l, double ranks, double reach) {
  double side[3], grown = 1, own = 1, left = ranks;
  for (int a = 0; a < 3; a++) side[a] = (double)l->size[a];
  while (left > 1) {
    int longest = 0;
    for (int a = 1; a < 3; a++)
      if (side[a] > side[longest]) longest = a;
    side[longest] /= fmin(2, left);
    left /= 2;
  }
  for (int a = 0; a < 3; a++) {
    own *= side[a];
    grown *= side[a] < (double)l->size[a] ? side[a] + 2 * reach : side[a];
  }
  return fmin(grown - own, (double)l->count - own);
}

void wcsph_ranks_memory(const struct plan *plan, int ranks, int threads,
                        struct ranks_memory *memory) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count, r = ranks;
  const double share = fluid / fmax(sites, 1);
  const double reach = plan->context.support / plan->context.spacing + GHOST_REACH;
  const double beside = r > 1 ? count_ghost_sites(l, r, reach) : 0;
  const double uneven = 0.5 * PARTITION_SLOTS * (r - 1) / fmax(fluid, 1);
  memory->held =
      beside * (share * (plan->bytes_fluid + GHOST_BYTES_EXTRA) + (1 - share) * plan->bytes_wall) +
      uneven * plan->bytes_method / r;
  memory->whole = threads * engine_bytes_thread(l, plan->context.support);
  memory->start = plan->context.driving > 0 ? PATH_BYTES * (sites + fluid) : 0;
  memory->shares_sites = true;
}
