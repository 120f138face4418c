/* What the descriptor of method stokes is made of. */
#ifndef TOSUI_SPHSOLVE_STOKES_METHOD_H
#define TOSUI_SPHSOLVE_STOKES_METHOD_H

#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/plan/ranks_forecast.h"

extern const struct effect *const stokes_effects[]; /* effects/registry.def */
enum status stokes_scales(struct plan *plan);
enum status stokes_cost(struct plan *plan, int threads);
enum status stokes_bytes_least(const struct plan *plan, double *bytes);
/* Bytes on each of so many ranks, their mean, while the lattice with mirrored sides is solved for
 * the error of the sides: it is whole on every rank while paths through its pores are sought, and
 * beside it are the second lattice of the cascade and the solution of the first. 0 where it is not
 * solved. */
double stokes_sides_bytes(const struct plan *plan, double ranks);
/* The same of one rank, on the finest lattice that a large effect may ask for. */
double stokes_sides_finer_bytes(const struct plan *plan);
void stokes_ranks_cost(const struct plan *plan, int ranks, int threads, struct ranks_cost *cost);

#endif
