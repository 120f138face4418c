/* Memory of method stokes on several ranks (docs/scaling.md). */
#include "sphsolve/stokes/method.h"
#include "sphsolve/stokes/constants.h"

#include <math.h>

#include "sphsolve/geometry/resample.h"
#include "sphsolve/stokes/cascade/cascade.h"
#include "sphsolve/stokes/solver/rows.h"

#define SLAB_PLANES_MIN 4.0 /* fewest planes of a slab */
#define MASK_BYTES 2.0      /* per row: a mask for each sixteen sites */
#define FLOOD_FLUID 4.0     /* per fluid site, during the percolation search */
#define RUN_BYTES 200e3     /* records of the run, whatever the size */

/* Size of the scene's lattice resampled to a given spacing (m), mirrored if requested. */
struct sites {
  double count, fluid, stride, rows, planes, plane; /* stride: row length in whole vectors */
};

static struct sites sites_at(const struct plan *plan, double spacing, bool mirrored) {
  const struct lattice *l = plan->context.lattice;
  const bool *unlike = l->model.unlike;
  size_t size[3], count;
  double n[3] = {0};
  if (lattice_resampled_size(l, spacing, size, &count) != STATUS_OK) {
    error_clear(); /* too many sites: the run itself reports it */
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

/* Mean bytes per rank of a solver without its lattice. Each slab stores ghost planes on both sides,
 * as many as the stencil reaches. */
static double solver_bytes(const struct plan *plan, const struct sites *s, double ranks) {
  const bool soil = plan->context.lattice->micro_porosity != NULL;
  const double whole = COARSER_BYTES * s->count, lattice = soil ? SOIL_BYTES : 0.0;
  const double divided = stokes_solver_bytes(s->count, s->fluid, soil) - whole -
                         (LATTICE_BYTES + lattice) * s->count +
                         FIELD_BYTES * (s->stride * s->rows - s->count);
  const double reach = floor(plan->context.support / plan->context.spacing);
  const double slabs = fmin(ranks, floor(s->planes / SLAB_PLANES_MIN)) / ranks;
  const double ghosts = ranks > 1.0 ? 2.0 * slabs *
                                          (reach * FIELD_BYTES * s->stride * s->rows / s->planes +
                                           2.0 * COARSE_BYTES * s->plane)
                                    : 0.0;
  return divided / ranks + whole + ghosts + SOLVER_BYTES;
}

static double rows_bytes(const struct sites *s) {
  return (ROW_BYTES + MASK_BYTES * s->stride / STOKES_LANES) * s->rows;
}

/* Mean bytes per rank while the mirrored lattice is solved at the given spacing (m). */
static double sides_bytes(const struct plan *plan, double spacing, double ranks) {
  const struct lattice *l = plan->context.lattice;
  const double base_spacing = plan->context.spacing;
  const double site = LATTICE_BYTES + (l->micro_porosity != NULL ? SOIL_BYTES : 0.0);
  const struct sites first = sites_at(plan, cascade_fixed_ratios[0] * base_spacing, false);
  const struct sites second = sites_at(plan, cascade_fixed_ratios[1] * base_spacing, false);
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

void stokes_ranks_memory(const struct plan *plan, int ranks, int threads,
                         struct ranks_memory *memory) {
  (void)threads;
  const size_t *n = plan->context.lattice->size;
  const double r = fmin(ranks, fmax(1, floor((double)n[2] / SLAB_PLANES_MIN)));
  const double nx = (double)n[0], ny = (double)n[1];
  memory->used = r;
  if (r > 1) { /* each ghost value is stored once */
    memory->held = 176 * 16 * ceil(nx / 16) * ny + 32 * nx * ny;
    memory->start = stokes_sides_bytes(plan, r);
  }
  memory->shares_sites = true;
}
