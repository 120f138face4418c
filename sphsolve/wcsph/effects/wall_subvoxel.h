/* No-slip at the true surface between the sites. The velocity of wall particle b continues the
 * profile through the surface,
 *
 * v_b = v_w - (v_a - v_w) d_b/d_a - kappa d_b (d_a + d_b), d the distances to the surface,
 *
 * first linearly (Morris, Fox, Zhu 1997, without their upper limit; d_a is at least .02 spacings),
 * then with the curvature kappa of the velocity (after Basa, Quinlan, Lastiwka 2009). The curvature
 * follows from the momentum equation: nu times twice kappa balances the viscous acceleration of a
 * itself, so with beta = sum_b V (-(1/r) dW/dr) d_b (d_a + d_b)
 *
 * A_viscous = A_linear / (1 - beta).
 *
 * Where the distances are not those of a smooth surface (edges, noise), beta is omitted. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_WALL_SUBVOXEL_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_WALL_SUBVOXEL_H

#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/engine/simd.h"

/* Weights of -(v_a - v_w) and of the curvature. Lengths in h. The distances of two points differ by
 * at most the length between them, so d_b is limited accordingly; `rough` increases where they
 * differ by more than a tenth beyond it. */
SIMD_INLINE void wall_subvoxel_pair(vec slope, vec s, vec d_a, vec inverse_d_a, vec d_b,
                                    vec *weight, vec *beta, vec *rough) {
  vec zero = vec_set(0.0f);
  *rough += vec_max(d_a + d_b - (float)WALL_SUBVOXEL_ROUGH * s, zero);
  d_b = vec_max(vec_min(d_b, s - d_a), zero);
  *weight = slope * (1.0f + d_b * inverse_d_a);
  *beta += slope * d_b * (d_a + d_b);
}

#ifdef EFFECTS /* for the plan alone (effects.c) */
#include <stdio.h>

#include "sphsolve/wcsph/scales.h"

static inline bool wcsph_wall_subvoxel_wanted(const struct effect_context *context,
                                              char why[EFFECT_WHY]) {
  return wcsph_wall_wanted(context, WALL_SUBVOXEL, why);
}
#endif

#endif

#ifdef EFFECTS
EFFECT(wall_subvoxel, .model = "no-slip at the true surface, second-order image velocity",
       .citation = "Morris, Fox, Zhu 1997; after Basa, Quinlan, Lastiwka 2009",
       .wanted = wcsph_wall_subvoxel_wanted)
#endif
