/* Pressure force, symmetric in the pair, so that momentum is conserved (Saomoto et al. 2006, eq. 7;
 * Monaghan 1992):
 *
 * dv_i/dt = - sum_j m (P_i/rho_i^2 + P_j/rho_j^2) grad_i W.
 *
 * With q = rho_0/rho, P/rho^2 = (c^2/rho_0) b, b = q - ratio q^2, ratio = rho_lattice/rho_0 for the
 * gauge pressure and 0 for the absolute one. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_PRESSURE_SYMMETRIC_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_PRESSURE_SYMMETRIC_H

#include "sphsolve/wcsph/engine/simd.h"

SIMD_INLINE vec pressure_symmetric_term(vec q, vec ratio) {
  return q * (1.0f - ratio * q);
}

/* Weight of the offset x_j - x_i; `slope` is -(dW/ds)/s. */
SIMD_INLINE vec pressure_symmetric_pair(vec b_i, vec b_j, vec slope) {
  return (b_i + b_j) * slope;
}

#endif

#ifdef EFFECTS
#include "sphsolve/wcsph/scales.h"
EFFECT(pressure_symmetric, .model = "pressure force, symmetric in the pair",
       .citation = "Saomoto et al. 2006, eq. 7", .wanted = wcsph_frozen_wanted,
       .dt_max = wcsph_pressure_dt, .limit = "sound", .dt_power = 1)
#endif
