/* What method stokes costs on several ranks (docs/scaling.md). */
#include "sphsolve/stokes/method.h"

#include <math.h>

#include "sphsolve/geometry/resample.h"
#include "sphsolve/stokes/cascade/cascade.h"
#include "sphsolve/stokes/solver/rows.h"

#define SLAB_LEAST 4.0 /* planes */
/* Of an iteration: */
#define COARSE_SECONDS 1.4e-9 /* a site, for the levels that every rank solves */
#define GATHERINGS 4.0        /* of a coarse level, from all to all */
#define MESSAGES 69.0
#define SUMS 3.8
/* Bytes of a site: kind and distance, its unpacked fields and coarse levels, the second and all
 * after it on every rank in full. */
#define LATTICE_BYTES 5.0
#define FIELD_BYTES 16.0
#define COARSE_BYTES 8.0
#define COARSER_BYTES 1.15
#define SOIL_BYTES 8.0 /* of each lattice, where there is soil */
/* Of a row: its start twice and its flux; of sixteen sites of it their mask. On every rank. */
#define ROW_BYTES 40.0
#define MASK_BYTES 2.0
#define SOLUTION_BYTES 32.0 /* a fluid site of the first lattice: velocity, pressure */
#define FLOOD_SITE 7.0      /* a site, while paths through the pores are sought, */
#define FLOOD_FLUID 4.0     /* and again a fluid site */
/* Of any size: stencil and sums of a solver, what the run notes of itself. */
#define SOLVER_BYTES 80e3
#define RUN_BYTES 200e3

/* A lattice of such a spacing from the scene's own, mirrored if so. */
struct sites {
  double count, fluid, stride, rows, planes, plane; /* stride: sites of a row, whole vectors */
};

static struct sites sites_at(const struct plan *plan, double spacing, bool mirrored) {
  const struct lattice *l = plan->context.lattice;
  const bool *unlike = l->model.unlike;
  size_t size[3], count;
  double n[3] = {0};
  if (lattice_resampled_size(l, spacing, size, &count) != STATUS_OK) {
    error_clear(); /* too many: the run says so */
    return (struct sites){.planes = 1.0};
  }
  for (int a = 0; a < 3; a++) n[a] = (double)size[a] * (mirrored && unlike[a] ? 2.0 : 1.0);
  const double all = n[0] * n[1] * n[2];
  return (struct sites){.count = all,
                        .fluid = all * (double)l->fluid_count / (double)l->count,
                        .stride = STOKES_LANES * ceil(n[0] / STOKES_LANES),
                        .rows = n[1] * n[2],
                        .planes = n[2],
                        .plane = n[0] * n[1]};
}

/* A solver without its lattice. Each slab has as many planes more on both sides as a stencil
 * reaches. */
static double solver_bytes(const struct plan *plan, const struct sites *s, double ranks) {
  const bool soil = plan->context.lattice->micro_porosity != NULL;
  const double whole = COARSER_BYTES * s->count, lattice = soil ? SOIL_BYTES : 0.0;
  const double own = stokes_solver_bytes(s->count, s->fluid, soil) - whole -
                     (LATTICE_BYTES + lattice) * s->count +
                     FIELD_BYTES * (s->stride * s->rows - s->count);
  const double reach = floor(plan->context.support / plan->context.spacing);
  const double slabs = fmin(ranks, floor(s->planes / SLAB_LEAST)) / ranks;
  const double ghosts = ranks > 1.0 ? 2.0 * slabs *
                                          (reach * FIELD_BYTES * s->stride * s->rows / s->planes +
                                           2.0 * COARSE_BYTES * s->plane)
                                    : 0.0;
  return own / ranks + whole + ghosts + SOLVER_BYTES;
}

static double rows_bytes(const struct sites *s) {
  return (ROW_BYTES + MASK_BYTES * s->stride / STOKES_LANES) * s->rows;
}

/* With the sides solved at such a spacing. */
static double sides_bytes(const struct plan *plan, double spacing, double ranks) {
  const struct lattice *l = plan->context.lattice;
  const double own = plan->context.spacing;
  const double site = LATTICE_BYTES + (l->micro_porosity != NULL ? SOIL_BYTES : 0.0);
  const struct sites first = sites_at(plan, cascade_fixed_ratios[0] * own, false);
  const struct sites second = sites_at(plan, cascade_fixed_ratios[1] * own, false);
  const struct sites wrapped = sites_at(plan, spacing, false);
  const struct sites sides = sites_at(plan, spacing, true);
  const double lattices =
      site * ((double)l->count / ranks + second.count + wrapped.count + sides.count);
  return RUN_BYTES + lattices + rows_bytes(&second) + rows_bytes(&sides) +
         SOLUTION_BYTES * first.fluid / ranks + solver_bytes(plan, &second, ranks) +
         fmax(FLOOD_SITE * sides.count + FLOOD_FLUID * sides.fluid,
              solver_bytes(plan, &sides, ranks));
}

double stokes_sides_bytes(const struct plan *plan, double ranks) {
  if (!(cascade_sides_sites(plan) > 0.0)) return 0.0;
  return sides_bytes(plan, cascade_sides_spacing(plan, plan->context.lattice), ranks);
}

double stokes_sides_finer_bytes(const struct plan *plan) {
  const struct lattice *l = plan->context.lattice;
  const double usual = cascade_sides_spacing(plan, l);
  double spacing = usual, sites;
  if (!(cascade_sides_sites(plan) > 0.0)) return 0.0;
  while (cascade_sides_finer(l, &spacing, &sites)) continue;
  return spacing < usual ? sides_bytes(plan, spacing, 1.0) : 0.0;
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
  if (r > 1) cost->start = stokes_sides_bytes(plan, r);
  cost->shares_sites = true;
}
