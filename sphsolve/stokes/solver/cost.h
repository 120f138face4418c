/* Predicted iterations and processor seconds of a solve. */
#ifndef TOSUI_SPHSOLVE_STOKES_COST_H
#define TOSUI_SPHSOLVE_STOKES_COST_H

#include "sphsolve/plan/plan.h"
#include "sphsolve/stokes/solver/step.h"

/* Iterations of GMRES until the goal is reached. */
double stokes_iterations(const struct pore_shape *pores, const struct stokes_goal *goal,
                         enum wall_scheme wall);
/* Ratio of the seconds of a solve with soil (pores below the site spacing) to those without; 1 if
 * the lattice has none. */
double stokes_soil_seconds(const struct lattice *lattice);
/* Processor seconds of a number of iterations and of the assembly before them. `sites`, `fluid`:
 * all sites and the fluid sites of the lattice. */
double stokes_seconds(double iterations, double sites, double fluid);
/* Processor seconds of a whole solve, on the lattice with its spacing divided by `refined`. */
double stokes_solver_seconds(const struct pore_shape *pores, const struct lattice *lattice,
                             double refined, const struct stokes_goal *goal, enum wall_scheme wall);

#endif
