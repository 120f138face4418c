/* The steady Stokes system of a lattice and its current solution (step.h improves it). Lattice
 * units: accelerations in units of `acceleration`, which is |driving| or follows from the fastest
 * moving wall; velocity in acceleration unit^2 / nu, pressure in rho acceleration unit. */
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
  float *residual;        /* first vector of the Krylov basis */
  double residual_start;  /* norm of the right-hand side */
  double residual_now;    /* norm of the residual over residual_start */
  double residual_before; /* the same before the last round */
  double divergence;      /* rms of the continuity residual over rms |grad v| */
  double mean[3];         /* volume integral of the velocity / bulk volume */
  double dissipating;     /* sites of a plane that dissipate, see stokes_solver_find_dissipating */
  double change;          /* relative change of the mean in the last round */
  bool exact;             /* the residual was computed from x, not updated by the Krylov cycles */
  long iterations;
  double bulk_count;
};

/* Assembles the system and its preconditioner for x = 0. If grid.active_all is 0 afterwards, there
 * is no path for the fluid and nothing to solve. `scene` (may be NULL) gives walls their velocity
 * and slip; support in m, nu in m^2/s, driving in m/s^2. Free with stokes_solver_free. */
enum status stokes_solver_build(const struct lattice *lattice, const struct scene *scene,
                                double support, enum wall_scheme wall, double nu,
                                const double driving[3], struct stokes_solver *solver);
/* The same, but solving only the lower half of a lattice that is mirrored together with its flow:
 * same k, half the sites. One process only: ranks divide whole lattices. */
enum status stokes_solver_build_half(const struct lattice *lattice, const struct scene *scene,
                                     double support, enum wall_scheme wall, double nu,
                                     const double driving[3], struct stokes_solver *solver);
void stokes_solver_free(struct stokes_solver *solver);
/* Assembles the operator again for a lattice that differs only in the permeability of the soil, and
 * must outlive the solver; solution and preconditioner are kept. */
enum status stokes_solver_set_soil(struct stokes_solver *solver, const struct lattice *lattice);
/* Mean velocity along the force in the solution of the present system, computed from an x that
 * solves a similar system. With the adjoint correction (Pierce, Giles 2000, SIAM Review 42) the
 * error is of second order in the difference of the two. At surfaces of soil, v approximates the
 * adjoint solution better than v / D does. */
double stokes_solver_functional(struct stokes_solver *solver);

/* Sets solver->dissipating of a solved system: the number of sites of a plane across the flow among
 * which the energy would be dissipated evenly, (sum of e)^2 / sum of (c e)^2 with e = v . (f - G
 * p), the power of force and pressure at a site (participation ratio, Bell, Dean 1970, Discuss.
 * Faraday Soc. 50: 55), and c, between `least` and 1, the uncertainty of the position of the wall
 * nearest to it in half spacings; the mean over the planes, weighted by their energy. */
enum status stokes_solver_find_dissipating(struct stokes_solver *solver, double least);

/* Number of vectors of the Krylov basis, and total bytes, for a model with so many sites of which
 * `active` are solved. `soil`: the model has soil. */
int stokes_solver_basis(double sites, double active, bool soil);
double stokes_solver_bytes(double sites, double active, bool soil);

/* To be called after x was changed by the caller: computes its residual, mean and divergence. */
void stokes_solver_restart(struct stokes_solver *solver);
/* Computes mean and divergence of x, and the norm of its residual. With `recompute` the residual is
 * first computed from x in double precision; else the one updated by the Krylov cycles is used. */
void stokes_solver_measure(struct stokes_solver *solver, bool recompute);

#endif
