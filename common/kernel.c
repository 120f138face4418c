#include "common/kernel.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

const char *const kernel_names[] = {
    [KERNEL_QUINTIC] = "quintic", [KERNEL_CUBIC] = "cubic", [KERNEL_WENDLAND] = "wendland", NULL};

double kernel_support_ratio(enum kernel kernel) {
  return kernel == KERNEL_QUINTIC ? 3 : 2;
}

static double normalisation(enum kernel kernel, int dimensions, double h) {
  if (kernel == KERNEL_QUINTIC) {
    if (dimensions == 1) return 1 / (120 * h);
    if (dimensions == 2) return 7 / (478 * M_PI * h * h);
    return 1 / (120 * M_PI * h * h * h);
  }
  if (kernel == KERNEL_WENDLAND)
    return dimensions == 2 ? 7 / (4 * M_PI * h * h) : 21 / (16 * M_PI * h * h * h);
  if (dimensions == 1) return 2 / (3 * h);
  if (dimensions == 2) return 10 / (7 * M_PI * h * h);
  return 1 / (M_PI * h * h * h);
}

static double power(double x, int n) {
  if (x <= 0) return 0;
  double x2 = x * x;
  return n == 5 ? x2 * x2 * x : n == 4 ? x2 * x2 : n == 3 ? x2 * x : x2;
}

double kernel_w(enum kernel kernel, int dimensions, double r, double h) {
  double s = r / h, alpha = normalisation(kernel, dimensions, h);
  if (kernel == KERNEL_QUINTIC)
    return alpha * (power(3 - s, 5) - 6 * power(2 - s, 5) + 15 * power(1 - s, 5));
  if (kernel == KERNEL_WENDLAND) return alpha * power(1 - s / 2, 4) * (1 + 2 * s);
  return alpha * (power(2 - s, 3) - 4 * power(1 - s, 3)) / 4;
}

double kernel_dw(enum kernel kernel, int dimensions, double r, double h) {
  double s = r / h, alpha = normalisation(kernel, dimensions, h) / h;
  if (kernel == KERNEL_QUINTIC)
    return -5 * alpha * (power(3 - s, 4) - 6 * power(2 - s, 4) + 15 * power(1 - s, 4));
  if (kernel == KERNEL_WENDLAND) return -5 * alpha * s * power(1 - s / 2, 3);
  return -3 * alpha * (power(2 - s, 2) - 4 * power(1 - s, 2)) / 4;
}
