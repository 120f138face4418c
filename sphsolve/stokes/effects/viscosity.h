/* Viscous acceleration on the lattice, nu = rho = V = 1: (A v)_a = sum_b c_ab (v_a - v_b),
 * c_ab = -2 (1/r) dW/dr (Morris, Fox, Zhu 1997 eq. 22, equal viscosities). Self-adjoint. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_VISCOSITY_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_VISCOSITY_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline double stokes_viscosity_pair(double r, double dw) {
  return -2.0 * dw / r;
}

static inline bool stokes_viscosity_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, "viscosity %g m^2/s balances the force", context->kinematic_viscosity);
  return true;
}

#endif

EFFECT(stokes_viscosity,
       .model = "viscous stencil on the lattice, sums scaled to be exact for a parabola",
       .citation = "Morris, Fox, Zhu 1997, eq. 22", .wanted = stokes_viscosity_wanted)
