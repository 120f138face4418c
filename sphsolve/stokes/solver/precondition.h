/* Block triangular preconditioner of the Stokes system (Elman, Silvester, Wathen 2014, ch. 9):
 *   p = S~^-1 r_p,  v = A~^-1 (r_v - D G p)
 * with two facts of pores put in. The velocity that a force alone would give, A kappa = 1, is the
 * shape every slow mode has: blocks of sites share one value times kappa, which makes the coarse
 * operators of A^-1 exact for it. And over distances longer than a pore is wide the pressure obeys
 * Darcy's law with kappa as the local permeability, over shorter ones the Schur complement is of
 * order one (Cahouet, Chabard 1988): S~^-1 = local + (-div kappa grad)^-1. Where pores are tight,
 * kappa varies by orders of magnitude, and this inverse has to be a good one: a two-grid cycle on
 * the lattice's own sites (darcy.h) with a W-cycle below. */
#ifndef TOSUI_SPHSOLVE_STOKES_PRECONDITION_H
#define TOSUI_SPHSOLVE_STOKES_PRECONDITION_H

#include "common/error.h"
#include "sphsolve/stokes/solver/multigrid.h"
#include "sphsolve/stokes/solver/operator.h"

struct stokes_preconditioner {
  struct stokes_operator *op;
  float *kappa; /* [n] */
  /* [n] The permeability that the pressure sees: kappa, but in soil no more than its own, as the
   * water of the pores drags that beneath the surface along. NULL without soil. */
  float *darcy;
  struct stokes_multigrid velocity, pressure;
};

/* For an assembled operator, which must outlive it: solves A kappa = 1 and coarsens. Collective. */
enum status stokes_preconditioner_build(struct stokes_operator *op,
                                        struct stokes_preconditioner *preconditioner);
void stokes_preconditioner_free(struct stokes_preconditioner *preconditioner);

/* y ~ K^-1 x; a fixed linear operation. `work` [components][n] is overwritten. */
void stokes_preconditioner_apply(struct stokes_preconditioner *preconditioner, const float *x,
                                 float *work, float *y);

#endif
