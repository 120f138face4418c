/* Dummy wall particles.
 *   v_w = 2 v_wall - sum_f v_f W / sum_f W                   Adami, Hu, Adams (2012), eq. 23
 *   p_w = (sum_f p_f W + (g - a_w) . sum_f rho_f r_wf W) / sum_f W                       eq. 27 */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_WALL_ADAMI_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_WALL_ADAMI_H

#include "sphsolve/wcsph/engine/simd.h"

/* sum: W, v W (3), p W, offset W (3). */
SIMD_INLINE void wall_adami_pair(vec w, vec x, vec y, vec z, vec vx, vec vy, vec vz, vec p,
                                 vec sum[8]) {
  sum[0] += w;
  sum[1] += w * vx;
  sum[2] += w * vy;
  sum[3] += w * vz;
  sum[4] += w * p;
  sum[5] += w * x;
  sum[6] += w * y;
  sum[7] += w * z;
}

#ifdef EFFECTS /* for the plan alone (effects.c) */
#include <stdio.h>

#include "sphsolve/wcsph/scales.h"

static inline bool wcsph_wall_adami_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  return wcsph_wall_wanted(context, WALL_ADAMI, why);
}
#endif

#endif

#ifdef EFFECTS
EFFECT(wall_adami, .model = "dummy wall particles with extrapolated velocity and pressure",
       .citation = "Adami, Hu, Adams 2012, eqs. 23, 27", .wanted = wcsph_wall_adami_wanted)
#endif
