/* Planes of a lattice shared out among the ranks: each has a run of them, and what lies beyond its
 * ends, around the periodic box, is a ghost. */
#ifndef TOSUI_COMMON_SLABS_H
#define TOSUI_COMMON_SLABS_H

#include <stddef.h>

#include "common/error.h"

struct slabs {
  int count;         /* ranks that have planes: 1 without MPI */
  size_t planes;     /* in all */
  size_t begin, end; /* of this rank */
  size_t *start;     /* [ranks + 1] */
  double imbalance;  /* work of the busiest rank over the mean */
};

/* Slabs of about equal work, `work[plane]` each, cut at multiples of `unit` planes and no thinner;
 * ranks that this leaves nothing to have no plane. */
enum status slabs_make(size_t planes, const double *work, size_t unit, struct slabs *slabs);
void slabs_free(struct slabs *slabs);

/* The first plane of a lattice whose planes are 2^shift of these that begins at `plane` or behind.
 */
static inline size_t slabs_coarse(size_t plane, int shift) {
  return (plane + ((size_t)1 << shift) - 1) >> shift;
}

/* Puts the ghost planes of a field under way, to be ended by ranks_wait: `data` is the whole
 * lattice's, planes of `bytes`; `depth` planes on both sides arrive where they belong. `shift` as
 * above. Nothing to do for one slab. */
void slabs_post(const struct slabs *slabs, int shift, void *data, size_t bytes, size_t depth);

#endif
