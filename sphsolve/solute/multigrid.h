/* Solves A b = source on the cells of a flow (cells.h): GMRES preconditioned by a multigrid cycle.
 *
 * The cycle uses the same operator with as much diffusion added to each face as keeps its smoother
 * stable (the hybrid scheme of Spalding 1972: |s F| / 2 at least). This affects only the
 * preconditioner; the system that is solved has no added diffusion. The smoother visits the planes
 * in the direction of the flow (downstream ordering, Wesseling 1992, 7.6), in each plane first
 * every other cell. Sums run in a fixed order: the results do not depend on the number of threads.
 */
#ifndef TOSUI_SPHSOLVE_SOLUTE_MULTIGRID_H
#define TOSUI_SPHSOLVE_SOLUTE_MULTIGRID_H

#include "sphsolve/solute/cells.h"
#include "sphsolve/stokes/solver/krylov.h"

#define SOLUTE_LEVELS 16

struct solute_solver {
  double s;  /* of the present operator */
  bool down; /* planes are visited from the last to the first */
  int level_count;
  struct solute_cells cells[SOLUTE_LEVELS]; /* [0]: those of the flow */
  float *inverse[SOLUTE_LEVELS]; /* inverse diagonal of the cycle's operator; 0 in closed cells */
  float *share[SOLUTE_LEVELS];   /* normalisation of the interpolation */
  float *x[SOLUTE_LEVELS], *rest[SOLUTE_LEVELS], *work[SOLUTE_LEVELS];
  struct stokes_krylov krylov;
};

/* Prepares the solver on the cells of the flow with its axes in the order `axis`, coarsened
 * `coarsenings` times; `down`: the flow goes in negative direction of the last axis. Free with
 * solute_solver_free. */
enum status solute_solver_build(const struct solute_flow *flow, const int axis[3], bool down,
                                int coarsenings, struct solute_solver *solver);
void solute_solver_free(struct solute_solver *solver);
/* Changes s >= 0. */
void solute_solver_set(struct solute_solver *solver, double s);

/* Improves b ([cells[0].size]) until the residual is `tolerance` times the norm of the source. The
 * problem determines b up to a constant in each connected pore; afterwards its mean is 0. Returns
 * the iterations and the relative residual reached. Failure (STATUS_NUMERIC): the residual stops
 * decreasing above `stalled`, which is at least `tolerance`. */
enum status solute_solver_solve(struct solute_solver *solver, const double *source,
                                double tolerance, double stalled, double *b, int *iterations,
                                double *reached);

#endif
