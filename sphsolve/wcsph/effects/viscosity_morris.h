/* Laminar viscosity.
 *   dv_i/dt = sum_j m (mu_i + mu_j)/(rho_i rho_j) (1/r) dW/dr (v_i - v_j)
 *                                                       Morris, Fox, Zhu (1997), eq. 22 */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_VISCOSITY_MORRIS_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_VISCOSITY_MORRIS_H

#include "sphsolve/wcsph/engine/simd.h"

SIMD_INLINE void viscosity_morris_pair(vec weight, vec dvx, vec dvy, vec dvz, vec sum[3]) {
  sum[0] += weight * dvx;
  sum[1] += weight * dvy;
  sum[2] += weight * dvz;
}

#endif
