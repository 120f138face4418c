/* Predicted cost of a plan on several ranks (docs/scaling.md): `explain --ranks N`. */
#ifndef TOSUI_SPHSOLVE_PLAN_RANKS_FORECAST_H
#define TOSUI_SPHSOLVE_PLAN_RANKS_FORECAST_H

#include <stdbool.h>

#include "sphsolve/plan/plan.h"

enum ranks_term {
  RANKS_COMPUTE,  /* distributed over the ranks, with the imbalance of slabs and chunks */
  RANKS_IN_FULL,  /* work that every rank repeats */
  RANKS_GATHERED, /* gathered on every rank */
  RANKS_GHOSTS,
  RANKS_SUMS, /* global sums */
  RANKS_TERMS
};

struct ranks_forecast {
  int ranks, used; /* used: ranks that have work */
  double seconds[RANKS_TERMS];
  double total;        /* s */
  double efficiency;   /* parallel efficiency relative to one rank */
  double memory_bytes; /* largest memory of a rank */
};

/* Set by a method's ranks_cost (struct method); numbers per step are those of the busiest rank. */
struct ranks_cost {
  double used;       /* ranks that have work */
  double uneven;     /* maximum work / mean work of the ranks */
  double in_full;    /* s for work that every rank repeats */
  double gathered;   /* bytes per step gathered on every rank */
  double ghosts;     /* bytes per step from the neighbours */
  double messages;   /* messages per step */
  double sums;       /* global sums per step */
  double whole;      /* bytes of data that every rank holds completely */
  double held;       /* further bytes per rank, besides its part of the rest */
  double start;      /* largest number of bytes before the first step */
  bool shares_sites; /* the ranks of a machine share kinds and wall distances */
};

/* `plan` is that of one rank with `threads` threads. */
void ranks_forecast(const struct plan *plan, int ranks, int threads,
                    struct ranks_forecast *forecast);
const char *ranks_term_name(enum ranks_term term);

#endif
