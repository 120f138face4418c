/* What a plan costs on several ranks (docs/scaling.md): `explain --ranks N`. */
#ifndef TOSUI_SPHSOLVE_PLAN_RANKS_FORECAST_H
#define TOSUI_SPHSOLVE_PLAN_RANKS_FORECAST_H

#include "sphsolve/plan/plan.h"

enum foreseen_term {
  FORESEEN_COMPUTE,  /* shared out, uneven slabs and chunks counted */
  FORESEEN_IN_FULL,  /* what every rank does for itself */
  FORESEEN_GATHERED, /* told to all by all */
  FORESEEN_GHOSTS,
  FORESEEN_SUMS, /* of all ranks */
  FORESEEN_TERMS
};

struct foreseen {
  int ranks, used; /* used: that get work */
  double seconds[FORESEEN_TERMS];
  double total;        /* s */
  double efficiency;   /* against one rank */
  double memory_bytes; /* of a rank, at most */
};

/* `plan` is that of one rank, of so many threads. */
void foresee(const struct plan *plan, int ranks, int threads, struct foreseen *foreseen);
const char *foreseen_name(enum foreseen_term term);

#endif
