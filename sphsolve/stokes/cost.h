/* Iterations and processor seconds of a solve, predicted. */
#ifndef TOSUI_SPHSOLVE_STOKES_COST_H
#define TOSUI_SPHSOLVE_STOKES_COST_H

#include "sphsolve/plan/error_forecast.h"
#include "sphsolve/stokes/step.h"

/* Of GMRES, until the goal is reached. */
double stokes_iterations(const struct pore_shape *pores, const struct stokes_goal *goal,
                         enum wall_scheme wall);
/* What soil with pores below the sites makes of seconds: times; 1 without. */
double stokes_soil_seconds(const struct lattice *lattice);
/* Processor seconds of so many iterations and what goes before, predicted. */
double stokes_seconds(double iterations, double sites, double fluid);
/* Of a solve, with the spacing divided by `refined`. */
double stokes_solver_seconds(const struct pore_shape *pores, const struct lattice *lattice,
                             double refined, const struct stokes_goal *goal, enum wall_scheme wall);

#endif
