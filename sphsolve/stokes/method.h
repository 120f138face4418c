/* What the descriptor of method stokes is made of. */
#ifndef TOSUI_SPHSOLVE_STOKES_METHOD_H
#define TOSUI_SPHSOLVE_STOKES_METHOD_H

#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/plan/ranks_forecast.h"

extern const struct effect *const stokes_effects[]; /* effects/registry.def */
enum status stokes_scales(struct plan *plan);
enum status stokes_cost(struct plan *plan, int threads);
void stokes_ranks_cost(const struct plan *plan, int ranks, int threads, struct ranks_cost *cost);

#endif
