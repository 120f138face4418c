/* Pressure force from differences, independent of a constant pressure and of the order of the
 * particles.
 *
 * dv_i/dt = -(1/rho_0) sum_j V (P_j - P_i) grad_i W, P of a wall = P_i, or adami's P_w
 *
 * The divergence of density_continuity.h is its exact transpose on the lattice. There is no
 * background pressure that would hold particles near a frozen lattice, so k does not depend on the
 * sound speed. (Morris, Fox, Zhu 1997 discuss the choice; Sun et al. 2017 use it under tension.) */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_PRESSURE_DIFFERENCE_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_PRESSURE_DIFFERENCE_H

#include "sphsolve/wcsph/engine/simd.h"

SIMD_INLINE vec pressure_difference_pair(vec p_i, vec p_j, vec slope) {
  return (p_j - p_i) * slope;
}

#endif

#ifdef EFFECTS
#include "sphsolve/wcsph/scales.h"
EFFECT(pressure_difference,
       .model = "pressure force from pressure differences, blind to the particle lattice",
       .citation = "Morris, Fox, Zhu 1997", .wanted = wcsph_continuity_wanted,
       .dt_max = wcsph_pressure_dt, .limit = "sound", .dt_power = 1)
#endif
