/* Solves A b = source between the cells of a flow (cells.h): GMRES with a multigrid cycle before
 * it.
 *
 * The cycle is of the same operator with as much diffusion added to each face as keeps its smoother
 * from growing (the hybrid scheme of Spalding 1972: |s F| / 2 at least); it only steers GMRES, what
 * is solved has none. Its smoother goes plane by plane the way the flow goes (downstream ordering,
 * Wesseling 1992, 7.6), in each plane first every other cell. Sums run in a fixed order: the bits
 * do not depend on the number of threads. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_MULTIGRID_H
#define TOSUI_SPHSOLVE_SOLUTE_MULTIGRID_H

#include "sphsolve/solute/cells.h"
#include "sphsolve/stokes/solver/krylov.h"

#define SOLUTE_LEVELS 16

struct solute_solver {
  double s;  /* of the operator at hand */
  bool down; /* planes are visited from the last to the first */
  int level_count;
  struct solute_cells cells[SOLUTE_LEVELS]; /* [0]: those of the flow */
  float *inverse[SOLUTE_LEVELS]; /* of the diagonal of the cycle's operator; 0 in cells closed */
  float *share[SOLUTE_LEVELS];   /* of what the coarser cells give (multigrid_rows.h) */
  float *x[SOLUTE_LEVELS], *rest[SOLUTE_LEVELS], *work[SOLUTE_LEVELS];
  struct stokes_krylov krylov;
};

/* The cells of the flow with its axes in the order `axis`, taken two by two by two `coarsenings`
 * times; `down`: it goes down the last axis. Free with solute_solver_free. */
enum status solute_solver_build(const struct solute_flow *flow, const int axis[3], bool down,
                                int coarsenings, struct solute_solver *solver);
void solute_solver_free(struct solute_solver *solver);
/* Another s >= 0. */
void solute_solver_set(struct solute_solver *solver, double s);

/* Improves b ([cells[0].size]) until the residual is `tolerance` of the source. Both have mean 0
 * afterwards as the problem has in each connected pore. Returns the iterations and what was
 * reached; a failure (STATUS_NUMERIC) is where it stops getting better above `stalled`, which is
 * `tolerance` at least. */
enum status solute_solver_solve(struct solute_solver *solver, const double *source,
                                double tolerance, double stalled, double *b, int *iterations,
                                double *reached);

#endif
