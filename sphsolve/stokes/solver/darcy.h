/* Darcy's law on the sites of the lattice, with the local permeability kappa: over distances longer
 * than the width of a pore the pressure of a Stokes flow obeys
 *   (T p)_a = sum over the six neighbours b of (kappa_a + kappa_b) / (2 dx^2) (p_a - p_b) = r_a.
 * Where there is soil the two halves of a link are in series, 2 kappa_a kappa_b / (kappa_a +
 * kappa_b), as kappa jumps at its surface. Matrix-free: T is computed from kappa in each call. */
#ifndef TOSUI_SPHSOLVE_STOKES_DARCY_H
#define TOSUI_SPHSOLVE_STOKES_DARCY_H

#include "sphsolve/stokes/solver/operator.h"

/* Unpacks kappa [n] for the calls below; it is valid until the operator is used otherwise. */
void stokes_darcy_begin(struct stokes_operator *op, const float *kappa);
/* p = omega diag(T)^-1 r: a damped Jacobi sweep from p = 0. */
void stokes_darcy_start(struct stokes_operator *op, const float *r, float *p);
/* out = r - T p. */
void stokes_darcy_residual(struct stokes_operator *op, const float *r, const float *p, float *out);
/* p += omega diag(T)^-1 (r - T p). */
void stokes_darcy_smooth(struct stokes_operator *op, const float *r, float *p);

#endif
