/* Iterative refinement: rounds of preconditioned GMRES in single precision on the residual in
 * double precision, until the goal is reached. */
#ifndef TOSUI_SPHSOLVE_STOKES_STEP_H
#define TOSUI_SPHSOLVE_STOKES_STEP_H

#include "sphsolve/stokes/solver/state.h"

/* Convergence criterion: this relative residual, with a divergence under 1e-4; or, if `residual` is
 * 0, an estimated relative error `mean` of the mean velocity. */
struct stokes_goal {
  double residual, mean;
  double slack; /* error of the mean that is accepted if the solve stalls */
};
/* The goal of a scene: stokes.tolerance if it is given, else scene.steady_tolerance. */
struct stokes_goal stokes_goal_of(const struct scene *scene);

/* One round: a Krylov cycle until the residual has fallen to a quarter or the basis is full; then
 * mean, divergence and change are updated. False after an interrupt: nothing has changed then. */
bool stokes_solver_round(struct stokes_solver *solver);
/* Estimated relative error of the mean velocity due to incomplete convergence, from the last
 * rounds. */
double stokes_solver_mean_error(const struct stokes_solver *solver);
bool stokes_solver_converged(struct stokes_solver *solver, const struct stokes_goal *goal);
/* Text on soil that may keep a solve from converging, and on what helps; empty if there is no such
 * soil. */
#define STOKES_HINT 240
void stokes_solver_soil_hint(const struct stokes_solver *solver, char text[STOKES_HINT]);
/* Iterates in rounds until the goal is reached. Returns STATUS_NUMERIC after ten rounds without
 * progress, unless the error is within goal->slack, and STATUS_INTERRUPTED after an interrupt. */
enum status stokes_solver_run(struct stokes_solver *solver, const struct stokes_goal *goal);

#endif
