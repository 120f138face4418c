#include "sphsolve/foresee.h"

#include <math.h>

/* Between ranks: bytes a second, and seconds a message; assumed, not measured. */
#define BANDWIDTH 10e9
#define LATENCY 2e-6

/* stokes, per iteration; its slabs are at least four planes. */
#define SLAB_LEAST 4.0
#define COARSE_SECONDS 1.4e-9 /* a site: levels that every rank solves */
#define STOKES_GATHERINGS 4.0
#define STOKES_MESSAGES 69.0
#define STOKES_SUMS 3.8
#define SITE_BYTES 5.0 /* kind and wall distance */
/* wcsph, per step: bytes of a ghost, how far ghosts reach in spacings, bytes of a particle that all
 * ranks are told when particles are ordered anew, and how often that is, about. */
#define WCSPH_GHOST 40.0
#define WCSPH_REACH 4.0
#define WCSPH_ORDERED 44.0
#define WCSPH_ORDER_STEPS 100.0
#define WCSPH_WHOLE 52.0 /* bytes of a particle on every rank */
/* isph: share of the time in the grid's cycle and in what follows a step, on every rank; bytes of a
 * particle told to all per step, and per iteration; iterations. */
#define WCSPH_CUT 2048.0 /* slots: cuts lie at multiples */
#define ISPH_IN_FULL 0.09
#define ISPH_TOLD 200.0
#define ISPH_RESIDUAL 8.0
#define ISPH_ITERATIONS 10.0
#define ISPH_WHOLE 520.0
#define ISPH_GHOST 130.0

/* Sites within `reach` of a rank's cube, at most all others. */
static double around(double sites, double ranks, double reach) {
  const double side = cbrt(sites / ranks);
  return fmin(pow(side + 2 * reach, 3) - side * side * side, sites - sites / ranks);
}

const char *foreseen_name(enum foreseen_term term) {
  static const char *const names[] = {"compute", "what every rank does in full",
                                      "what all tell all", "ghosts", "sums"};
  return names[term];
}

void foresee(const struct plan *plan, int ranks, int threads, struct foreseen *f) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count, steps = plan->steps;
  const double share = fluid / fmax(sites, 1);
  double r = ranks, uneven = 1, whole = 0, told = 0, ghosts = 0, messages = 0, sums = 0, in_full = 0;
  if (plan->context.method == METHOD_STOKES) {
    const double nx = (double)l->size[0], ny = (double)l->size[1], planes = (double)l->size[2];
    r = fmin(r, fmax(1, floor(planes / SLAB_LEAST)));
    uneven = ceil(fmax(1, planes / SLAB_LEAST) / r) * r / fmax(1, planes / SLAB_LEAST);
    in_full = steps * COARSE_SECONDS * sites * (1 - 1 / r) / threads;
    told = (1 - 1 / r) * sites * STOKES_GATHERINGS / 64 * sizeof(float);
    ghosts = 176 * 16 * ceil(nx / 16) * ny + 32 * nx * ny;
    messages = STOKES_MESSAGES, sums = STOKES_SUMS;
    whole = SITE_BYTES * sites;
  } else if (plan->context.method == METHOD_WCSPH) {
    uneven = 1 + 0.5 * WCSPH_CUT * (r - 1) / fmax(fluid, 1);
    ghosts = WCSPH_GHOST * share * around(sites, r, WCSPH_REACH);
    told = (1 - 1 / r) * WCSPH_ORDERED / WCSPH_ORDER_STEPS * fluid;
    messages = 2 * fmin(r - 1, 12), sums = 2;
    whole = SITE_BYTES * sites + WCSPH_WHOLE * fluid + plan->bytes_wall * (double)l->wall_count;
  } else {
    in_full = ISPH_IN_FULL * (1 - 1 / r) * plan->seconds;
    told = (1 - 1 / r) * (ISPH_TOLD + ISPH_RESIDUAL * ISPH_ITERATIONS) * fluid;
    ghosts = ISPH_GHOST * plan->context.scene->isph.support_ratio * pow(fluid, 2.0 / 3) *
             fmin(2, r - 1); /* slabs */
    messages = (6 + ISPH_ITERATIONS) * fmin(r - 1, 6), sums = 4 * ISPH_ITERATIONS;
    whole = ISPH_WHOLE * fluid;
  }
  *f = (struct foreseen){.ranks = ranks, .used = (int)r};
  f->seconds[FORESEEN_COMPUTE] = plan->seconds / r * (r > 1 ? uneven : 1);
  if (r > 1) {
    f->seconds[FORESEEN_IN_FULL] = in_full;
    f->seconds[FORESEEN_GATHERED] = steps * told / BANDWIDTH;
    f->seconds[FORESEEN_GHOSTS] = steps * (ghosts / BANDWIDTH + messages * LATENCY);
    f->seconds[FORESEEN_SUMS] = steps * sums * LATENCY * ceil(log2(r));
  }
  for (int t = 0; t < FORESEEN_TERMS; t++) f->total += f->seconds[t];
  f->efficiency = plan->seconds / (ranks * f->total);
  whole = fmin(whole, plan->bytes_total);
  f->memory_bytes = whole + (plan->bytes_total - whole) / r;
}
