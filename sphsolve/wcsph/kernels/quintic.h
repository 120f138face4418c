/* The quintic spline (Schoenberg 1946; Morris, Fox, Zhu 1997) on vectors, s = r/h, without its
 * normalisation alpha (common/kernel.h):
 *
 * W/alpha = (3 - s)^5 - 6 (2 - s)^5 + 15 (1 - s)^5, each term only while positive.
 *
 * Terms beyond their range are set to 0 by max(., 0), so that a pair out of range gives exactly
 * zero without a branch. The factors 6 and 15 of the powers are included in their bases. */
#ifndef TOSUI_SPHSOLVE_WCSPH_KERNELS_QUINTIC_H
#define TOSUI_SPHSOLVE_WCSPH_KERNELS_QUINTIC_H

#include "sphsolve/wcsph/engine/simd.h"

#define KERNEL_NAME quintic
#define KERNEL_AT_0 66 /* W/alpha at s = 0 */

/* W / alpha. */
SIMD_INLINE vec kernel_vector_w(vec s) {
  const float k2 = 1.430969081f, k1 = 1.718771928f; /* 6^(1/5), 15^(1/5) */
  vec zero = vec_set(0.0f), t3 = vec_max(3.0f - s, zero), t2 = vec_max(2.0f * k2 - k2 * s, zero),
      t1 = vec_max(k1 - k1 * s, zero);
  vec q3 = t3 * t3, q2 = t2 * t2, q1 = t1 * t1;
  return (q3 * q3) * t3 - (q2 * q2) * t2 + (q1 * q1) * t1;
}

/* -(dW/ds)/(5 alpha): never negative. */
SIMD_INLINE vec kernel_vector_slope(vec s) {
  const float k2 = 1.565084580f, k1 = 1.967989671f; /* 6^(1/4), 15^(1/4) */
  vec zero = vec_set(0.0f), t3 = vec_max(3.0f - s, zero), t2 = vec_max(2.0f * k2 - k2 * s, zero),
      t1 = vec_max(k1 - k1 * s, zero);
  vec q3 = t3 * t3, q2 = t2 * t2, q1 = t1 * t1;
  return q3 * q3 - q2 * q2 + q1 * q1;
}

#endif
