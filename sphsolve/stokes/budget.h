/* Conservation budget of a steady solution. */
#ifndef TOSUI_SPHSOLVE_STOKES_BUDGET_H
#define TOSUI_SPHSOLVE_STOKES_BUDGET_H

#include "sphsolve/output/conservation.h"
#include "sphsolve/stokes/solver/state.h"

/* Fills flux_open, force_open and power_open of the conservation budget. Collective. */
enum status stokes_balance(const struct stokes_solver *solver, struct conservation *conservation);

#endif
