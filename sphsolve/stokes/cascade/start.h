/* A solve begins where a coarser one has ended. */
#ifndef TOSUI_SPHSOLVE_STOKES_START_H
#define TOSUI_SPHSOLVE_STOKES_START_H

#include "sphsolve/stokes/state.h"

/* The solution alone of a solver: grid, stencil, units and x; all else is freed. */
void stokes_solver_strip(struct stokes_solver *solver);

/* Sets x of `fine`, built and not yet iterated, from the solution of `coarse` on another lattice of
 * the same body, linear between its sites, and measures it. One rank only. */
enum status stokes_solver_start(struct stokes_solver *fine, const struct stokes_solver *coarse);

#endif
