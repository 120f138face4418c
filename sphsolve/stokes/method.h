/* What the descriptor of method stokes is made of. */
#ifndef TOSUI_SPHSOLVE_STOKES_METHOD_H
#define TOSUI_SPHSOLVE_STOKES_METHOD_H

#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/plan/ranks_forecast.h"

extern const struct effect *const stokes_effects[]; /* effects/registry.def */
enum status stokes_scales(struct plan *plan);
enum status stokes_cost(struct plan *plan, int threads);
/* On each of so many ranks while the lattice with other sides is solved, whole on every rank while
 * its pores are followed, beside the second of the cascade and the solution of the first; `held`:
 * of ghosts. 0 where it is not. */
double stokes_sides_bytes(const struct plan *plan, double ranks, double held);
void stokes_ranks_cost(const struct plan *plan, int ranks, int threads, struct ranks_cost *cost);

#endif
