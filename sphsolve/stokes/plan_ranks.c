/* What method stokes costs on several ranks (docs/scaling.md). */
#include "sphsolve/stokes/method.h"

#include <math.h>

#include "sphsolve/stokes/cascade/cascade.h"

#define SLAB_LEAST 4.0 /* planes */
/* Of an iteration: */
#define COARSE_SECONDS 1.4e-9 /* a site, for the levels that every rank solves */
#define GATHERINGS 4.0        /* of a coarse level, from all to all */
#define MESSAGES 69.0
#define SUMS 3.8
/* Bytes a site: kind and distance, and a quarter of both before they are mirrored. */
#define SIDES_BYTES 6.25
#define ROW_BYTES 48.0 /* of a row: its start twice, its flux, its mask; on every rank */
#define SITE_BYTES 5.0
#define SOIL_BYTES 8.0      /* of each, where there is soil */
#define SOLUTION_BYTES 32.0 /* a fluid site of the first lattice: velocity, pressure */
#define FLOOD_SITE 7.0      /* a site, while paths through the pores are sought, */
#define FLOOD_FLUID 4.0     /* and again a fluid site */

/* Sites along x of the lattice that is mirrored to one of so many sites. */
static double side_of(double sides, const struct lattice *l) {
  return (double)l->size[0] * cbrt(sides / cascade_sides_copies(l) / (double)l->count);
}

static double sides_bytes(const struct plan *plan, double sides, double ranks, double held) {
  const struct lattice *l = plan->context.lattice;
  const double sites = (double)l->count, phi = (double)l->fluid_count / sites;
  const double first = sites / pow(cascade_fixed_ratios[0], l->dimensions);
  const double second = sites / pow(cascade_fixed_ratios[1], l->dimensions);
  const bool soil = l->micro_porosity != NULL;
  const double fields = soil ? SOIL_BYTES : 0.0;
  if (!(sides > 0.0)) return 0.0;
  return (SIDES_BYTES + 1.25 * fields) * sides + (SITE_BYTES + fields) * (second + sites / ranks) +
         held +
         fmax((FLOOD_SITE + FLOOD_FLUID * phi) * sides,
              stokes_solver_bytes(sides, phi * sides, soil) / ranks) +
         stokes_solver_bytes(second, phi * second, soil) / ranks +
         SOLUTION_BYTES * phi * first / ranks +
         ROW_BYTES * (second / ((double)l->size[0] / cascade_fixed_ratios[1]) +
                      sides / (2 * side_of(sides, l)));
}

double stokes_sides_bytes(const struct plan *plan, double ranks, double held) {
  return sides_bytes(plan, cascade_sides_sites(plan), ranks, held);
}

double stokes_sides_finer_bytes(const struct plan *plan) {
  const struct lattice *l = plan->context.lattice;
  double spacing = cascade_sides_spacing(plan, l), most = 0.0, sites;
  if (!(cascade_sides_sites(plan) > 0.0)) return 0.0;
  while (cascade_sides_finer(l, &spacing, &sites)) most = sides_bytes(plan, sites, 1.0, 0.0);
  return most;
}

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
  cost->held = r > 1 ? cost->ghosts : 0; /* each is stored once */
  cost->messages = MESSAGES;
  cost->sums = SUMS;
  if (r > 1) cost->start = stokes_sides_bytes(plan, r, cost->held);
  cost->shares_sites = true;
}
