/* Density by summation over all particles, including grains,
 *
 * rho_i = sum_j m W(r_ij) (Saomoto et al. 2006, eq. 6)
 *
 * and the pressure from it, P = c^2 rho (absolute) or P = c^2 (rho - rho_lattice) (gauge), where
 * rho_lattice is the sum on the undisturbed lattice, so that fluid at rest has no pressure. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_DENSITY_SUMMATION_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_DENSITY_SUMMATION_H

#include "sphsolve/wcsph/engine/simd.h"

SIMD_INLINE void density_summation_pair(vec w, vec *sum) {
  *sum += w;
}

#endif

#ifdef EFFECTS
#include "sphsolve/wcsph/scales.h"
EFFECT(density_summation,
       .model = "density summed over fluid and grains, pressure c^2 (rho - rho_lattice) or c^2 rho",
       .citation = "Saomoto et al. 2006, eq. 6", .wanted = wcsph_frozen_wanted)
#endif
