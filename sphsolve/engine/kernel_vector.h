/* The quintic spline (common/kernel.h) on vectors, without its normalisation and in units of h:
 * s = r/h. Terms beyond their reach are cut by max(., 0), so that a pair out of range gives an
 * exact zero and needs no branch. */
#ifndef TOSUI_ENGINE_KERNEL_VECTOR_H
#define TOSUI_ENGINE_KERNEL_VECTOR_H

#include "sphsolve/engine/simd.h"

/* W / alpha. */
SIMD_INLINE vec kernel_vector_w(vec s) {
  vec zero = vec_set(0.0f);
  vec t3 = vec_max(3.0f - s, zero), t2 = vec_max(2.0f - s, zero), t1 = vec_max(1.0f - s, zero);
  vec q3 = t3 * t3, q2 = t2 * t2, q1 = t1 * t1;
  vec w3 = q3 * q3 * t3, w2 = q2 * q2 * t2, w1 = q1 * q1 * t1;
  return w3 - 6.0f * w2 + 15.0f * w1;
}

/* -(dW/ds)/(5 alpha): never negative. */
SIMD_INLINE vec kernel_vector_slope(vec s) {
  vec zero = vec_set(0.0f);
  vec t3 = vec_max(3.0f - s, zero), t2 = vec_max(2.0f - s, zero), t1 = vec_max(1.0f - s, zero);
  vec q3 = t3 * t3, q2 = t2 * t2, q1 = t1 * t1;
  return q3 * q3 - 6.0f * (q2 * q2) + 15.0f * (q1 * q1);
}

#endif
