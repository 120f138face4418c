/* Solves the steady Stokes system of a lattice: rounds of preconditioned GMRES in single precision
 * on the residual in double precision. Lattice units: accelerations in `acceleration`, |driving| or
 * what a moving wall imposes; velocity in acceleration unit^2 / nu, pressure in rho acceleration
 * unit. */
#ifndef TOSUI_SPHSOLVE_STOKES_SOLVER_H
#define TOSUI_SPHSOLVE_STOKES_SOLVER_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "sphsolve/plan/error_forecast.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/stokes/grid.h"
#include "sphsolve/stokes/krylov.h"
#include "sphsolve/stokes/operator.h"
#include "sphsolve/stokes/precondition.h"
#include "sphsolve/stokes/stencil.h"
#include "sphsolve/scene/scene.h"

struct stokes_solver {
  struct stokes_stencil stencil;
  struct stokes_grid grid;
  struct stokes_operator operator;
  struct stokes_preconditioner preconditioner;
  struct stokes_krylov krylov;
  double acceleration, velocity_unit; /* m/s^2, m/s */
  double force[3];                    /* driving / acceleration */
  bool walls_move;
  double *x;              /* [components][active] velocities, then pressure */
  float *residual;        /* in the Krylov basis */
  double residual_start;  /* norm of the right-hand side */
  double residual_now;    /* relative */
  double residual_before; /* and before the last round */
  double divergence;      /* rms of the continuity residual over rms |grad v| */
  double mean[3];         /* volume integral of the velocity / bulk volume */
  double change;          /* of the mean in the last round, relative */
  bool exact;             /* the residual was found from x, not carried on by the Krylov cycles */
  long iterations;
  double bulk_count;
};

/* With grid.active_all == 0 there is no path for the fluid and nothing to solve. `scene` (may be
 * NULL) gives walls their velocity and slip, support in m, nu in m^2/s, driving in m/s^2. */
enum status stokes_solver_build(const struct lattice *lattice, const struct scene *scene,
                                double support, enum wall_scheme wall, double nu,
                                const double driving[3], struct stokes_solver *solver);
/* The same on the lower half of a lattice that is mirrored, with its flow: same k, half the sites.
 * One process only: ranks cut whole lattices. */
enum status stokes_solver_build_half(const struct lattice *lattice, const struct scene *scene,
                                     double support, enum wall_scheme wall, double nu,
                                     const double driving[3], struct stokes_solver *solver);
void stokes_solver_free(struct stokes_solver *solver);

/* When a solve ends: at this relative residual with a divergence under 1e-4; or, where `residual`
 * is 0, when the mean is within `mean` of what it converges to, relative. */
struct stokes_goal {
  double residual, mean;
};
/* stokes.tolerance where the scene gives one, else scene.steady_tolerance. */
struct stokes_goal stokes_goal_of(const struct scene *scene);

/* Vectors of the Krylov basis and bytes in all that a model of that many sites, `active` of them
 * solved, takes. */
int stokes_solver_basis(double sites, double active);
double stokes_solver_bytes(double sites, double active);
/* Processor seconds of so many iterations and what goes before, predicted. */
double stokes_seconds(double iterations, double sites, double fluid);
/* Of a solve, with the spacing divided by `refined`. */
double stokes_solver_seconds(const struct pore_shape *pores, const struct lattice *lattice,
                             double refined, const struct stokes_goal *goal, enum wall_scheme wall);

/* After x was changed from outside: residual, mean and divergence of it. */
void stokes_solver_restart(struct stokes_solver *solver);
/* One round, a Krylov cycle until the residual is a quarter or the basis full; mean, divergence and
 * change are those after it. False where krylov.stop gave it up: nothing has changed then. */
bool stokes_solver_round(struct stokes_solver *solver);
/* How far the mean is from where it converges to, relative, from the last rounds. */
double stokes_solver_mean_error(const struct stokes_solver *solver);
bool stokes_solver_converged(struct stokes_solver *solver, const struct stokes_goal *goal);
/* Rounds until converged; no progress in ten rounds is STATUS_NUMERIC, an interrupt
 * STATUS_INTERRUPTED. */
enum status stokes_solver_run(struct stokes_solver *solver, const struct stokes_goal *goal);

#endif
