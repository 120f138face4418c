/* Wendland's C2 function (Wendland 1995; Dehnen, Aly 2012, table 1) on vectors, s = r/h, without
 * its normalisation alpha (common/kernel.h):
 *
 * W/alpha = (1 - s/2)^4 (1 + 2 s), -(dW/ds)/alpha = 5 s (1 - s/2)^3, s < 2.
 *
 * Its Fourier transform is positive everywhere, so particles do not pair for any number of
 * neighbours. The base is limited by max(., 0), so that a pair out of range gives exactly zero. */
#ifndef TOSUI_SPHSOLVE_WCSPH_KERNELS_WENDLAND_H
#define TOSUI_SPHSOLVE_WCSPH_KERNELS_WENDLAND_H

#include "sphsolve/wcsph/engine/simd.h"

#define KERNEL_NAME wendland
#define KERNEL_AT_0 1.0 /* W/alpha at s = 0 */

/* W / alpha. */
SIMD_INLINE vec kernel_vector_w(vec s) {
  vec t = vec_max(1.0f - 0.5f * s, vec_set(0.0f)), t2 = t * t;
  return t2 * t2 * (1.0f + 2.0f * s);
}

/* -(dW/ds)/(5 alpha): never negative. */
SIMD_INLINE vec kernel_vector_slope(vec s) {
  vec t = vec_max(1.0f - 0.5f * s, vec_set(0.0f));
  return s * t * (t * t);
}

#endif
