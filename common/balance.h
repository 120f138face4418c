/* A row of items cut into runs of about equal work, one for each rank: Zoltan's recursive bisection
 * in one dimension. common/balance.c is the only file that knows Zoltan. */
#ifndef TOSUI_COMMON_BALANCE_H
#define TOSUI_COMMON_BALANCE_H

#include <stddef.h>

#include "common/error.h"

#ifdef TOSUI_MPI
/* Collective. Of `items` items this rank tells the work of `own`, from `first` on. cut [ranks + 1]
 * comes out the same on all: rank r has [cut[r], cut[r + 1]), which may be none. */
enum status balance_cut(size_t items, size_t first, size_t own, const double *work, size_t *cut);
#else
static inline enum status balance_cut(size_t items, size_t first, size_t own, const double *work,
                                      size_t *cut) {
  (void)first, (void)own, (void)work;
  cut[0] = 0, cut[1] = items;
  return STATUS_OK;
}
#endif

#endif
