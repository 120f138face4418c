#include "sphsolve/plan/ranks_forecast.h"

#include <math.h>

#include "sphsolve/wcsph/engine/engine.h"

/* Between ranks: bytes a second, and seconds a message; assumed, not measured. */
#define BANDWIDTH 10e9
#define LATENCY 2e-6

/* stokes, per iteration; its slabs are at least four planes. */
#define SLAB_LEAST 4.0
#define COARSE_SECONDS 1.4e-9 /* a site: levels that every rank solves */
#define STOKES_GATHERINGS 4.0
#define STOKES_MESSAGES 69.0
#define STOKES_SUMS 3.8
/* Kind and wall distance: once on a machine of so many cores. */
#define SITE_BYTES 5.0
#define MACHINE_CORES 64.0
/* wcsph: bytes of a ghost sent per step; how far ghosts reach beyond the support, in spacings: the
 * width of their clusters and of the own; bytes that a ghost takes beyond a particle, for messages
 * less lists; and what every rank holds for a site, and as much for a fluid one, while it looks for
 * a path through the pores. */
#define WCSPH_GHOST 40.0
#define WCSPH_REACH 2.5
#define WCSPH_HELD 25.0
#define WCSPH_PATH 4.0
#define WCSPH_CUT 2048.0 /* slots: cuts lie at multiples */
/* isph: share of the time in the grid's cycle, on every rank; bytes of a particle told to all per
 * iteration (the residual on the grid, and sums of chunks); iterations; bytes on every rank, of the
 * grid for a particle, of lattice and cells for a site, and of a wall particle; bytes of a ghost;
 * how thick its layers are, in supports; and bytes of a ghost that travel, a step. */
#define ISPH_IN_FULL 0.07
#define ISPH_TOLD 1.6
#define ISPH_ITERATIONS 10.0
#define ISPH_GRID 40.0
#define ISPH_SITE 6.0
#define ISPH_WALL 31.0
#define ISPH_HELD 440.0
#define ISPH_LAYERS 1.25
#define ISPH_GHOST 240.0

/* Sites within `reach` of a rank's part, at most all others: the lattice, halved across its longest
 * side again and again. */
static double around(const struct lattice *l, double ranks, double reach) {
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

/* Particles of the walls around the domain. */
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

const char *foreseen_name(enum foreseen_term term) {
  static const char *const names[] = {"compute", "what every rank does in full",
                                      "what all tell all", "ghosts", "sums"};
  return names[term];
}

void foresee(const struct plan *plan, int ranks, int threads, struct foreseen *f) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, fluid = (double)l->fluid_count, steps = plan->steps;
  const double share = fluid / fmax(sites, 1);
  double r = ranks, uneven = 1, whole = 0, held = 0, told = 0, ghosts = 0, messages = 0, sums = 0,
         in_full = 0, start = 0;
  if (plan->context.method == METHOD_STOKES) {
    const double nx = (double)l->size[0], ny = (double)l->size[1], planes = (double)l->size[2];
    r = fmin(r, fmax(1, floor(planes / SLAB_LEAST)));
    uneven = ceil(fmax(1, planes / SLAB_LEAST) / r) * r / fmax(1, planes / SLAB_LEAST);
    in_full = steps * COARSE_SECONDS * sites * (1 - 1 / r) / threads;
    told = (1 - 1 / r) * sites * STOKES_GATHERINGS / 64 * sizeof(float);
    ghosts = 176 * 16 * ceil(nx / 16) * ny + 32 * nx * ny;
    held = r > 1 ? ghosts : 0; /* each has its place */
    messages = STOKES_MESSAGES, sums = STOKES_SUMS;
  } else if (plan->context.method == METHOD_WCSPH) {
    uneven = 1 + 0.5 * WCSPH_CUT * (r - 1) / fmax(fluid, 1);
    const double reach = plan->context.support / plan->context.spacing + WCSPH_REACH;
    const double beside = r > 1 ? around(l, r, reach) : 0;
    ghosts = WCSPH_GHOST * share * beside;
    messages = 2 * fmin(r - 1, 12), sums = 2;
    held = beside * (share * (plan->bytes_fluid + WCSPH_HELD) + (1 - share) * plan->bytes_wall);
    whole = threads * engine_bytes_thread(l, plan->context.support);
    held += (uneven - 1) * plan->bytes_method / r;
    start = plan->context.driving > 0 ? WCSPH_PATH * (sites + fluid) : 0;
  } else {
    in_full = ISPH_IN_FULL * (1 - 1 / r) * plan->seconds;
    told = (1 - 1 / r) * ISPH_TOLD * ISPH_ITERATIONS * fluid;
    const double layers = ISPH_LAYERS * plan->context.scene->isph.support_ratio;
    const double surface = pow(fluid, l->dimensions == 2 ? 1.0 / 2 : 2.0 / 3);
    const double beside = fmin(layers * surface * fmin(2, r - 1), fluid - fluid / r); /* slabs */
    ghosts = ISPH_GHOST * beside;
    messages = (6 + ISPH_ITERATIONS) * fmin(r - 1, 6), sums = 4 * ISPH_ITERATIONS;
    whole = ISPH_GRID * fluid + ISPH_SITE * sites + ISPH_WALL * walls_around(plan);
    held = ISPH_HELD * beside;
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
  whole = fmin(whole + PROGRAM_BYTES, plan->bytes_total);
  f->memory_bytes = fmax(whole + (plan->bytes_total - whole) / r + held, start + PROGRAM_BYTES);
  /* Shared out among the ranks of a machine, not of all. */
  if (plan->context.method != METHOD_ISPH && r > 1)
    f->memory_bytes += SITE_BYTES * sites * (1 / fmin(r, ceil(MACHINE_CORES / threads)) - 1 / r);
}
