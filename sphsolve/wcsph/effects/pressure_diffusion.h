/* Diffusion of pressure, against the checkerboard that central differences do not see.
 *   dp_i/dt += D sum_j 2 V (-(1/r) dW/dr) (p_j - p_i)
 * Molteni, Colagrossi (2009), eq. 9, without gradient correction. Beside walls D = gamma c^2, so
 * that the steady divergence it leaves, gamma lap p, depends neither on the sound speed nor on the
 * step; that needs more than an explicit step bears, so p_i itself is taken at the end of the step:
 * the sum of weights w gives p_i' = p_i + dt rate/(1 + dt D w), which only slows sound down. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_PRESSURE_DIFFUSION_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_PRESSURE_DIFFUSION_H

#include "sphsolve/wcsph/engine/simd.h"

/* The weight of (p_j - p_i) is slope times a constant; their sum. */
SIMD_INLINE void pressure_diffusion_pair(vec slope, vec *weights) {
  *weights += slope;
}

#endif

#ifdef EFFECTS
#include "sphsolve/wcsph/scales.h"
EFFECT(pressure_diffusion, .model = "diffusion of pressure against checkerboards",
       .citation = "Molteni, Colagrossi 2009, eq. 9", .wanted = wcsph_continuity_wanted,
       .switches_on = EFFECT_SWITCH(struct engine_settings, diffusion))
#endif
