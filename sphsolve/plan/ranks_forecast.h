/* What a plan costs on several ranks (docs/scaling.md): `explain --ranks N`. */
#ifndef TOSUI_SPHSOLVE_PLAN_RANKS_FORECAST_H
#define TOSUI_SPHSOLVE_PLAN_RANKS_FORECAST_H

#include <stdbool.h>

#include "sphsolve/plan/plan.h"

enum ranks_term {
  RANKS_COMPUTE,  /* divided among the ranks, as unevenly as slabs and chunks are */
  RANKS_IN_FULL,  /* what every rank does for itself */
  RANKS_GATHERED, /* gathered on every rank */
  RANKS_GHOSTS,
  RANKS_SUMS, /* of all ranks */
  RANKS_TERMS
};

struct ranks_forecast {
  int ranks, used; /* used: that get work */
  double seconds[RANKS_TERMS];
  double total;        /* s */
  double efficiency;   /* against one rank */
  double memory_bytes; /* of a rank, at most */
};

/* What a method's ranks_cost fills (struct method); numbers a step are those of the busiest rank.
 */
struct ranks_cost {
  double used;       /* ranks that get work */
  double uneven;     /* work of the busiest over the mean */
  double in_full;    /* s that every rank spends on what is not divided */
  double gathered;   /* bytes a step that are gathered on every rank */
  double ghosts;     /* bytes a step from the neighbours */
  double messages;   /* a step */
  double sums;       /* of all ranks, a step */
  double whole;      /* bytes of what every rank holds in full */
  double held;       /* bytes beside its part of the rest */
  double start;      /* bytes at most before the first step */
  bool shares_sites; /* kinds and wall distances lie once on a machine */
};

/* `plan` is that of one rank, of so many threads. */
void ranks_forecast(const struct plan *plan, int ranks, int threads,
                    struct ranks_forecast *forecast);
const char *ranks_term_name(enum ranks_term term);

#endif
