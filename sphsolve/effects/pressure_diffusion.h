/* Diffusion of pressure, against the checkerboard that central differences do not see.
 *   dp_i/dt += D sum_j 2 V (-(1/r) dW/dr) (p_j - p_i)
 * Molteni, Colagrossi (2009), eq. 9, without gradient correction. D = delta h c, and never more
 * than makes the steady divergence it leaves (tau = D/(rho c^2) = .005 dx^2/mu) matter. */
#ifndef TOSUI_EFFECT_PRESSURE_DIFFUSION_H
#define TOSUI_EFFECT_PRESSURE_DIFFUSION_H

#include "sphsolve/engine/simd.h"

SIMD_INLINE void pressure_diffusion_pair(vec slope, vec p_i, vec p_j, vec *sum) {
  *sum += slope * (p_j - p_i);
}

#endif
