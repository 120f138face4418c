/* Block triangular preconditioner of the Stokes system (Elman, Silvester, Wathen 2014, ch. 9):
 *   p = S~^-1 r_p,  v = A~^-1 (r_v - D G p)
 * adapted to pores in two ways. All slow modes of A have the shape of the velocity that a uniform
 * force alone would cause, A kappa = 1: a block of sites shares one value times kappa, which makes
 * the coarse operators of A^-1 exact for it. Over distances longer than the width of a pore the
 * pressure obeys Darcy's law with kappa as the local permeability, over shorter ones the Schur
 * complement is of order one (Cahouet, Chabard 1988): S~^-1 = local + (-div kappa grad)^-1. In
 * tight pores kappa varies by orders of magnitude, and this inverse must be accurate: a two-grid
 * cycle on the lattice's own sites (darcy.h) with a W-cycle below. */
#ifndef TOSUI_SPHSOLVE_STOKES_PRECONDITION_H
#define TOSUI_SPHSOLVE_STOKES_PRECONDITION_H

#include "common/error.h"
#include "sphsolve/stokes/solver/multigrid.h"
#include "sphsolve/stokes/solver/operator.h"

struct stokes_preconditioner {
  struct stokes_operator *op;
  float *kappa; /* [n] */
  /* [n] Permeability in the pressure equation: kappa, but in soil at most the soil's own, because
   * kappa there includes the flow that the water in the pores drags along beneath the surface. NULL
   * without soil. */
  float *darcy;
  struct stokes_multigrid velocity, pressure;
};

/* Builds the preconditioner of an assembled operator, which must outlive it: solves A kappa = 1 and
 * coarsens. Collective. Free with stokes_preconditioner_free. */
enum status stokes_preconditioner_build(struct stokes_operator *op,
                                        struct stokes_preconditioner *preconditioner);
void stokes_preconditioner_free(struct stokes_preconditioner *preconditioner);

/* y ~ K^-1 x; a fixed linear operation. `work` [components][n] is overwritten. */
void stokes_preconditioner_apply(struct stokes_preconditioner *preconditioner, const float *x,
                                 float *work, float *y);

#endif
