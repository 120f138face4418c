#ifndef TOSUI_SPHSOLVE_STOKES_OUTPUT_H
#define TOSUI_SPHSOLVE_STOKES_OUTPUT_H

#include "sphsolve/output/recorder.h"
#include "sphsolve/stokes/solver/state.h"
#include "sphsolve/output/conservation.h"

/* Writes a snapshot of all fluid sites of the lattice. Of the solver, grid, stencil and x are
 * read. */
enum status stokes_write_snapshot(const struct scene *scene, const struct lattice *lattice,
                                  const struct stokes_solver *solver, struct recorder *recorder);

/* Conservation budget of a steady solution. */

/* Fills flux_open, force_open and power_open of the conservation budget. Collective. */
enum status stokes_balance(const struct stokes_solver *solver, struct conservation *conservation);

#endif
