/* Kernels for the pairs of method isph as functions of the support radius he, fast enough for the
 * pair loop: W and the slope -W'(r)/r, of which all operators are made (grad W = -slope r_ij). The
 * forms are those of common/kernel.h, which the tests compare with. */
#ifndef TOSUI_SPHSOLVE_ISPH_KERNEL_H
#define TOSUI_SPHSOLVE_ISPH_KERNEL_H

#include <math.h>

#include "common/kernel.h"

static inline void isph_kernel_cubic(int dimensions, double r, double he, double *w,
                                     double *slope) {
  double h = 0.5 * he, inverse = 1 / h, q = r * inverse;
  double alpha =
      dimensions == 3 ? M_1_PI * inverse * inverse * inverse : 10 / (7 * M_PI) * inverse * inverse;
  double two = 2 - q, one = q < 1 ? 1 - q : 0;
  *w = alpha * 0.25 * (two * two * two - 4 * one * one * one);
  *slope = alpha * 0.75 * inverse * (two * two - 4 * one * one) / (r + 1e-9 * h);
}

static inline void isph_kernel_quintic(int dimensions, double r, double he, double *w,
                                       double *slope) {
  double h = he / 3, inverse = 1 / h, q = r * inverse;
  double alpha = dimensions == 3 ? M_1_PI / 120 * inverse * inverse * inverse
                                 : 7 / (478 * M_PI) * inverse * inverse;
  double three = 3 - q, two = q < 2 ? 2 - q : 0, one = q < 1 ? 1 - q : 0;
  double t4 = three * three * three * three, d4 = two * two * two * two, o4 = one * one * one * one;
  *w = alpha * (t4 * three - 6 * d4 * two + 15 * o4 * one);
  *slope = alpha * 5 * inverse * (t4 - 6 * d4 + 15 * o4) / (r + 1e-9 * h);
}

/* For r < he. */
static inline void isph_kernel(enum kernel kernel, int dimensions, double r, double he, double *w,
                               double *slope) {
  if (kernel == KERNEL_CUBIC)
    isph_kernel_cubic(dimensions, r, he, w, slope);
  else
    isph_kernel_quintic(dimensions, r, he, w, slope);
}

/* Integral of the one-dimensional cubic kernel from -infinity to t = x/h. */
static inline double kernel_integral(double t) {
  double s = fabs(t), half;
  if (s >= 2)
    half = 0.5;
  else if (s <= 1)
    half = 2.0 / 3 * (s - s * s * s / 2 + 3 * s * s * s * s / 16);
  else
    half = 11.0 / 24 + (1 - pow(2 - s, 4)) / 24;
  return t < 0 ? 0.5 - half : 0.5 + half;
}

#endif
