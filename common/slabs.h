/* Distribution of the planes of a lattice over the ranks: each rank has a contiguous range (slab)
 * of planes, and the planes beyond its ends, periodically, are ghosts. */
#ifndef TOSUI_COMMON_SLABS_H
#define TOSUI_COMMON_SLABS_H

#include <stddef.h>

#include "common/error.h"

struct slabs {
  int count;         /* ranks that have planes; 1 without MPI */
  size_t planes;     /* planes of the lattice */
  size_t begin, end; /* planes of this rank */
  size_t *start;     /* [ranks + 1] */
  double imbalance;  /* work of the busiest rank over the mean */
};

/* Makes slabs of about equal work, `work[plane]` each, with boundaries at multiples of `unit`
 * planes. If there are too few units some ranks have no planes. */
enum status slabs_make(size_t planes, const double *work, size_t unit, struct slabs *slabs);
void slabs_free(struct slabs *slabs);

/* For a coarse lattice with one plane for each 2^shift planes of this one: its first plane at or
 * after `plane`. */
static inline size_t slabs_coarse(size_t plane, int shift) {
  return (plane + ((size_t)1 << shift) - 1) >> shift;
}

/* Starts the exchange of the ghost planes of a field, to be completed by ranks_wait. `data` is the
 * whole lattice, with planes of `bytes`; `depth` planes on both sides of the slab are received in
 * place. `shift` as for slabs_coarse. Does nothing for a single slab. */
void slabs_post(const struct slabs *slabs, int shift, void *data, size_t bytes, size_t depth);

#endif
