/* The steady Stokes system of a lattice and its solution so far (step.h improves it). Lattice
 * units: accelerations in `acceleration`, |driving| or what a moving wall imposes; velocity in
 * acceleration unit^2 / nu, pressure in rho acceleration unit. */
#ifndef TOSUI_SPHSOLVE_STOKES_STATE_H
#define TOSUI_SPHSOLVE_STOKES_STATE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/stokes/solver/grid.h"
#include "sphsolve/stokes/solver/krylov.h"
#include "sphsolve/stokes/solver/operator.h"
#include "sphsolve/stokes/solver/precondition.h"
#include "sphsolve/stokes/solver/stencil.h"
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
/* The operator anew for a lattice that differs in the soil's permeability alone, and outlives it;
 * solution and preconditioner are those of before. */
enum status stokes_solver_set_soil(struct stokes_solver *solver, const struct lattice *lattice);
/* Mean velocity along the force in the solution of the system at hand, from an x that solves a
 * nearby one: by the adjoint correction (Pierce, Giles 2000, SIAM Review 42) the error is of the
 * second order in the difference of the two. At surfaces of soil the adjoint of v is nearer to v
 * than to v / D. */
double stokes_solver_functional(struct stokes_solver *solver);

/* Vectors of the Krylov basis and bytes in all that a model of that many sites, `active` of them
 * solved, takes; with `soil` where the model has some. */
int stokes_solver_basis(double sites, double active, bool soil);
double stokes_solver_bytes(double sites, double active, bool soil);

/* After x was changed from outside: residual, mean and divergence of it. */
void stokes_solver_restart(struct stokes_solver *solver);
/* Residual, flux and divergence of x. With `anew` the residual is found from x in double precision;
 * else that which the Krylov cycles carried on stands. */
void stokes_solver_measure(struct stokes_solver *solver, bool anew);

#endif
