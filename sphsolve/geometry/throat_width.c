#include "sphsolve/geometry/throat_width.h"

#include <math.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "sphsolve/geometry/percolation.h"

/* Bisection ends when the width is known to this share of itself, or of half a spacing. */
#define WIDTH_TOLERANCE 0.05

/* Whether sites at least `distance` (m) from the walls lead through the lattice. */
static enum status leads_through(const struct lattice *l, const double driving[3], double distance,
                                 uint8_t *kind, bool *leads) {
  struct lattice wide = *l;
  const float least = (float)distance;
  wide.kind = kind;
#pragma omp parallel for schedule(static)
  for (size_t s = 0; s < l->count; s++)
    kind[s] = l->kind[s] == SITE_FLUID && l->wall_distance[s] >= least ? SITE_FLUID : SITE_WALL;
  return percolation_find(&wide, driving, false, NULL, leads);
}

enum status throat_width_find(const struct lattice *l, const double driving[3], double *width) {
  enum status status = STATUS_OK;
  uint8_t *kind = NULL;
  bool leads;
  const double spacing = fmin(l->spacing[0], fmin(l->spacing[1], l->spacing[2]));
  double low = 0.0, high = 0.0;
  *width = INFINITY;
  if (l->wall_distance == NULL) return STATUS_OK;
  TRY(memory_allocate(&kind, l->count, 1, "pores by their width"));
  TRY(leads_through(l, driving, 0.0, kind, &leads));
  *width = 0.0;
  if (!leads) goto cleanup;
  for (high = 0.5 * spacing; leads; high *= 2.0) {
    TRY(interrupt_look());
    TRY(leads_through(l, driving, high, kind, &leads));
    if (!leads) break;
    low = high;
    /* Without walls across a direction the distance is not bounded. */
    if (high > spacing * (double)l->count) break;
  }
  while (!leads && high - low > WIDTH_TOLERANCE * fmax(low, 0.5 * spacing)) {
    const double middle = 0.5 * (low + high);
    bool through;
    TRY(interrupt_look());
    TRY(leads_through(l, driving, middle, kind, &through));
    *(through ? &low : &high) = middle;
  }
  *width = 2.0 * fmax(low, 0.25 * WIDTH_TOLERANCE * spacing);
cleanup:
  memory_free(&kind);
  return status;
}
