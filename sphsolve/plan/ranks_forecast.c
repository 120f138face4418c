#include "sphsolve/plan/ranks_forecast.h"

#include <math.h>

#include "sphsolve/plan/constants.h"
#include "sphsolve/plan/method.h"

const char *ranks_term_name(enum ranks_term term) {
  static const char *const names[] = {"compute", "what every rank does in full",
                                      "gathering on every rank", "ghosts", "sums"};
  return names[term];
}

void ranks_forecast(const struct plan *plan, int ranks, int threads, struct ranks_forecast *f) {
  const double sites = (double)plan->context.lattice->count, steps = plan->steps;
  struct ranks_cost c = {.used = ranks, .uneven = 1};
  plan->context.method->ranks_cost(plan, ranks, threads, &c);
  const double r = c.used;
  *f = (struct ranks_forecast){.ranks = ranks, .used = (int)r};
  f->seconds[RANKS_COMPUTE] = plan->seconds / r * (r > 1 ? c.uneven : 1);
  if (r > 1) {
    f->seconds[RANKS_IN_FULL] = c.in_full;
    f->seconds[RANKS_GATHERED] = steps * c.gathered / BANDWIDTH;
    f->seconds[RANKS_GHOSTS] = steps * (c.ghosts / BANDWIDTH + c.messages * LATENCY);
    f->seconds[RANKS_SUMS] = steps * c.sums * LATENCY * ceil(log2(r));
  }
  for (int t = 0; t < RANKS_TERMS; t++) f->total += f->seconds[t];
  f->efficiency = plan->seconds / (ranks * f->total);
  const double all = (plan->bytes_total - PROGRAM_BYTES) / (1.0 + MEMORY_OVERHEAD);
  const double whole = fmin(c.whole, all);
  f->memory_bytes = fmax(whole + (all - whole) / r + c.held, c.start);
  /* Distributed over the ranks of a machine, not over all ranks. */
  if (c.shares_sites && r > 1)
    f->memory_bytes += SITE_BYTES * sites * (1 / fmin(r, ceil(MACHINE_CORES / threads)) - 1 / r);
  f->memory_bytes = PROGRAM_BYTES + (1.0 + MEMORY_OVERHEAD) * f->memory_bytes;
}
