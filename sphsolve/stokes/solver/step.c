#include "sphsolve/stokes/solver/step.h"
#include "sphsolve/stokes/constants.h"

#include <math.h>
#include <omp.h>
#include <stdio.h>

#include "sphsolve/geometry/soil.h"

/* Factor by which a round reduces the residual. */
#define ROUND_REDUCTION 0.25
/* Relative residual of a solution that is exact up to rounding. */
#define RESIDUAL_EXACT 1e-6
/* The same where there is soil. */
#define RESIDUAL_ROUNDING 1e-7

/* Relative residual to reach where the scene gives no tolerance. */
#define RESIDUAL_DEFAULT 1e-6

struct stokes_goal stokes_goal_of(const struct scene *scene) {
  struct stokes_goal goal = {.residual = scene->stokes.tolerance, .mean = scene->steady_tolerance};
  if (isnan(goal.residual)) goal.residual = goal.mean > 0.0 ? 0.0 : RESIDUAL_DEFAULT;
  return goal;
}

/* Safety factor on the estimated error of the mean. */
#define MEAN_SAFETY 2.0

/* The error of the flux is proportional to the square of the residual (to the residual itself where
 * walls move, as there is no adjoint correction then). Let a round leave the fraction q of that
 * error: the flux has changed by (1 - q) of its error before the round, and the remaining error is
 *   q / (1 - q) times the change in the round.
 * By chance, however, a round may leave the flux unchanged: the first round after a start from
 * another lattice's solution does so with a flux twice the true one. The square of the residual is
 * therefore a lower bound. For a residual spread over the pores like the force it is the error of
 * the flux; for the residuals that are left in rocks the error is 5 to 100 times as large
 * (docs/physics/stokes.md). */
double stokes_solver_mean_error(const struct stokes_solver *s) {
  const double ratio = s->residual_now / s->residual_before;
  const double q = s->walls_move ? ratio : ratio * ratio;
  /* If all of the flux is in soil, its part of the initial residual may be small. */
  const double exact = s->operator.soil ? RESIDUAL_ROUNDING : RESIDUAL_EXACT;
  if (s->residual_now <= exact) return fmin(s->change, RESIDUAL_EXACT);
  const double least = s->walls_move ? s->residual_now : s->residual_now * s->residual_now;
  return s->change < 1.0 && q < 1.0 ? fmax(least, MEAN_SAFETY * s->change * q / (1.0 - q))
                                    : INFINITY;
}

/* Below this fraction of the initial residual the single precision of the Krylov vectors matters:
 * the residual is then computed in double precision after each round. */
#define RESIDUAL_RECOMPUTE 1e-4

bool stokes_solver_round(struct stokes_solver *s) {
  double reached;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(s->operator.threads);
  const int done = stokes_krylov_correct(&s->krylov, ROUND_REDUCTION, s->x, &reached);
  if (done > 0) {
    s->iterations += done;
    s->exact = false;
    /* Adami walls are not part of the operator, only of the residual. */
    stokes_solver_measure(s, s->operator.wall == WALL_ADAMI ||
                             reached * s->residual_now<RESIDUAL_RECOMPUTE);
  }
  omp_set_num_threads(threads);
  return done > 0 || s->residual_now == 0.0;
}

bool stokes_solver_converged(struct stokes_solver *s, const struct stokes_goal *goal) {
  if (goal->residual > 0.0) {
    if (!(s->residual_now <= goal->residual && s->divergence <= 1e-4 && s->change <= 1e-4))
      return false;
    return s->exact;
  }
  return stokes_solver_mean_error(s) <= goal->mean;
}

void stokes_solver_soil_hint(const struct stokes_solver *s, char text[STOKES_HINT]) {
  const struct lattice *l = s->operator.lattice;
  double least = INFINITY;
  text[0] = '\0';
  if (l->micro_porosity == NULL) return;
  for (size_t i = 0; i < l->count; i++)
    if (lattice_is_soil(l, i)) least = fmin(least, (double)l->micro_permeability[i]);
  const double relative = least / (s->stencil.unit * s->stencil.unit);
  if (relative >= SOIL_HARD) return;
  snprintf(text, STOKES_HINT,
           ": soil of k_micro = %.2g m^2, %.1e spacing^2, is hard to solve; a model with it as "
           "grain bounds k from below, one with k_micro = 0.01 spacing^2 from above",
           least, relative);
}

enum status stokes_solver_run(struct stokes_solver *s, const struct stokes_goal *goal) {
  double best = INFINITY;
  if (s->grid.active_all == 0) return STATUS_OK;
  for (int stalled = 0; stalled < 10;) {
    if (!stokes_solver_round(s)) return FAIL(STATUS_INTERRUPTED, "interrupted");
    if (stokes_solver_converged(s, goal)) return STATUS_OK;
    stalled = s->residual_now < STALLED_REDUCTION * best ? 0 : stalled + 1;
    best = fmin(best, s->residual_now);
  }
  if (stokes_solver_mean_error(s) <= goal->slack) return STATUS_OK;
  char soil[STOKES_HINT];
  stokes_solver_soil_hint(s, soil);
  return FAIL(STATUS_NUMERIC,
              "stokes: no progress after %ld iterations at a residual of %.1e%s; a larger "
              "stokes.tolerance accepts it",
              s->iterations, s->residual_now, soil);
}
