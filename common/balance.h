/* A row of items divided into runs of about equal work, one for each rank: Zoltan's recursive
 * bisection in one dimension. common/balance.c is the only file that knows Zoltan. */
#ifndef TOSUI_COMMON_BALANCE_H
#define TOSUI_COMMON_BALANCE_H

#include <stddef.h>

#include "common/error.h"

#ifdef TOSUI_MPI
/* Collective. Of `items` items this rank tells the work of `own`, from `first` on. `partition`,
 * of ranks + 1, comes out the same on all: rank r has [partition[r], partition[r + 1]), which may
 * be none. */
enum status balance_partition(size_t items, size_t first, size_t own, const double *work,
                              size_t *partition);
#else
static inline enum status balance_partition(size_t items, size_t first, size_t own,
                                            const double *work, size_t *partition) {
  (void)first, (void)own, (void)work;
  partition[0] = 0, partition[1] = items;
  return STATUS_OK;
}
#endif

#endif
