/* Partition of a row of items into contiguous ranges of about equal work, one per rank, by Zoltan's
 * recursive bisection in one dimension. Only common/balance.c uses Zoltan. */
#ifndef TOSUI_COMMON_BALANCE_H
#define TOSUI_COMMON_BALANCE_H

#include <stddef.h>

#include "common/error.h"

#ifdef TOSUI_MPI
/* Partitions `items` items by work. Collective: this rank gives work[own] of the items [first,
 * first + own). On all ranks partition[ranks + 1] is the same afterwards: rank r has the items
 * [partition[r], partition[r + 1]), possibly none. */
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
