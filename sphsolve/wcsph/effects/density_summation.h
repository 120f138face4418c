/* Density by summation over all particles, grains included.
 *   rho_i = sum_j m W(r_ij)                             Saomoto et al. (2006), eq. 6
 * and the pressure from it, P = c^2 rho (absolute) or P = c^2 (rho - rho_lattice) (gauge), where
 * rho_lattice is the sum on the undisturbed lattice, so that fluid at rest carries no pressure. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_DENSITY_SUMMATION_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_DENSITY_SUMMATION_H

#include "sphsolve/wcsph/engine/kernel_vector.h"

SIMD_INLINE void density_summation_pair(vec s, vec *sum) {
  *sum += kernel_vector_w(s);
}

#endif
