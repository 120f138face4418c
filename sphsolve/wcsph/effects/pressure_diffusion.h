/* Diffusion of pressure, to damp alternating pressures, which central differences do not detect.
 *
 * dp_i/dt += D sum_j 2 V (-(1/r) dW/dr) (p_j - p_i) (Molteni, Colagrossi 2009, eq. 9, without
 * gradient correction)
 *
 * Next to walls D = gamma c^2, so that the remaining steady divergence, gamma lap p, depends
 * neither on the sound speed nor on the step. This exceeds the stability limit of an explicit step,
 * so p_i itself is taken at the end of the step: with the sum of weights w, p_i' = p_i + dt rate/(1
 * + dt D w), which only reduces the speed of sound. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_PRESSURE_DIFFUSION_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_PRESSURE_DIFFUSION_H

#include "sphsolve/wcsph/engine/simd.h"

/* Sum of the weights of (p_j - p_i), which are proportional to `slope`. */
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
