/* Rounds of preconditioned GMRES in single precision on the residual in double precision, until the
 * flow is good enough. */
#ifndef TOSUI_SPHSOLVE_STOKES_STEP_H
#define TOSUI_SPHSOLVE_STOKES_STEP_H

#include "sphsolve/stokes/state.h"

/* When a solve ends: at this relative residual with a divergence under 1e-4; or, where `residual`
 * is 0, when the mean is within `mean` of what it converges to, relative. */
struct stokes_goal {
  double residual, mean;
  double slack; /* error of the mean that will do where there is no progress any more */
};
/* stokes.tolerance where the scene gives one, else scene.steady_tolerance. */
struct stokes_goal stokes_goal_of(const struct scene *scene);

/* One round, a Krylov cycle until the residual is a quarter or the basis full; mean, divergence and
 * change are those after it. False where a signal has come: nothing has changed then. */
bool stokes_solver_round(struct stokes_solver *solver);
/* How far the mean is from where it converges to, relative, from the last rounds. */
double stokes_solver_mean_error(const struct stokes_solver *solver);
bool stokes_solver_converged(struct stokes_solver *solver, const struct stokes_goal *goal);
/* Why soil may keep a solve from converging, and what helps; empty where there is no such soil. */
#define STOKES_HINT 240
void stokes_solver_soil_hint(const struct stokes_solver *solver, char text[STOKES_HINT]);
/* Rounds until converged; no progress in ten rounds is STATUS_NUMERIC, unless within the slack, an
 * interrupt STATUS_INTERRUPTED. */
enum status stokes_solver_run(struct stokes_solver *solver, const struct stokes_goal *goal);

#endif
