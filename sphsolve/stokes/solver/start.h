/* Initial solution of a lattice from that of a coarser one. */
#ifndef TOSUI_SPHSOLVE_STOKES_START_H
#define TOSUI_SPHSOLVE_STOKES_START_H

#include "sphsolve/stokes/solver/state.h"

/* Reduces a solver to its solution: grid, stencil, units and x; all else is freed. */
void stokes_solver_strip(struct stokes_solver *solver);

/* Sets x of `fine`, built and not yet iterated, by linear interpolation of the solution of `coarse`
 * on another lattice of the same body, and computes its residual and flux. One rank only. */
enum status stokes_solver_start(struct stokes_solver *fine, const struct stokes_solver *coarse);

#endif
