/* Parts of the descriptor of method stokes. */
#ifndef TOSUI_SPHSOLVE_STOKES_METHOD_H
#define TOSUI_SPHSOLVE_STOKES_METHOD_H

#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"

extern const struct effect *const stokes_effects[]; /* effects/registry.def */
enum status stokes_scales(struct plan *plan);
enum status stokes_cost(struct plan *plan, int threads);
enum status stokes_bytes_least(const struct plan *plan, double *bytes);
/* Bytes while the mirrored lattice is solved for the error of the sides, on the finest lattice that
 * a large effect of the sides may require; 0 if no such lattice is solved. */
double stokes_sides_finer_bytes(const struct plan *plan);

#endif
