#include "common/statistics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/constants.h"
#include "common/memory.h"

void add_compensated(double *sum, double *lost, double value) {
  const double next = *sum + value;
  *lost += fabs(*sum) >= fabs(value) ? (*sum - next) + value : (value - next) + *sum;
  *sum = next;
}

double sum_compensated(const double *values, size_t n) {
  double sum = 0, lost = 0;
  for (size_t i = 0; i < n; i++) add_compensated(&sum, &lost, values[i]);
  return sum + lost;
}

void batch_means(const double *values, size_t n, double *mean, double *standard_error) {
  *mean = n > 0 ? sum_compensated(values, n) / (double)n : NAN;
  *standard_error = NAN;
  if (n < 4) return;
  size_t batches = (size_t)sqrt((double)n), length = n / batches, skip = n - batches * length;
  double spread = 0;
  for (size_t b = 0; b < batches; b++) {
    double d = sum_compensated(values + skip + b * length, length) / (double)length - *mean;
    spread += d * d;
  }
  *standard_error = sqrt(spread / (double)(batches - 1) / (double)batches);
}

enum status fit_linear(const double *x, const double *y, size_t n, int through_origin,
                       struct linear_fit *fit) {
  *fit = (struct linear_fit){0, NAN, NAN, NAN, NAN};
  if (n < (through_origin ? 1u : 2u))
    return FAIL(STATUS_INPUT, "a line needs %d points or more", through_origin ? 1 : 2);
  double mean_x = 0, mean_y = 0;
  if (!through_origin) {
    mean_x = sum_compensated(x, n) / (double)n;
    mean_y = sum_compensated(y, n) / (double)n;
  }
  double sxx = 0, sxy = 0, syy = 0;
  for (size_t i = 0; i < n; i++) {
    sxx += (x[i] - mean_x) * (x[i] - mean_x);
    sxy += (x[i] - mean_x) * (y[i] - mean_y);
    syy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  if (!(sxx > 0)) return FAIL(STATUS_INPUT, "all points have the same abscissa: no line fits");
  fit->slope = sxy / sxx;
  fit->intercept = through_origin ? 0 : mean_y - fit->slope * mean_x;
  double residual = 0;
  for (size_t i = 0; i < n; i++) {
    double d = y[i] - fit->intercept - fit->slope * x[i];
    residual += d * d;
  }
  fit->r_squared = syy > 0 ? 1 - residual / syy : 1;
  size_t parameters = through_origin ? 1 : 2;
  if (n > parameters) {
    double variance = residual / (double)(n - parameters);
    fit->slope_error = sqrt(variance / sxx);
    fit->intercept_error =
        through_origin ? 0 : sqrt(variance * (1 / (double)n + mean_x * mean_x / sxx));
  }
  return STATUS_OK;
}

double student_t95(double dof) {
  if (!(dof >= 1)) return NAN;
  /* Exact to three digits for small `dof`, where the expansion (Abramowitz, Stegun 26.7.5) is
   * inaccurate. */
  const double small[] = {STUDENT_95_1, STUDENT_95_2, STUDENT_95_3, STUDENT_95_4, STUDENT_95_5,
                          STUDENT_95_6, STUDENT_95_7, STUDENT_95_8, STUDENT_95_9};
  if (dof < 9) {
    int i = (int)dof;
    double rest = dof - i, high = small[i];
    return small[i - 1] + rest * (high - small[i - 1]);
  }
  double z = NORMAL_95, z3 = z * z * z, z5 = z3 * z * z;
  return z + (z3 + z) / (4 * dof) + (5 * z5 + 16 * z3 + 3 * z) / (96 * dof * dof);
}

void histogram(const double *values, size_t n, double low, double high, size_t bins,
               double *counts) {
  for (size_t b = 0; b < bins; b++) counts[b] = 0;
  double scale = (double)bins / (high - low);
  for (size_t i = 0; i < n; i++) {
    if (!(values[i] >= low && values[i] <= high)) continue;
    size_t b = (size_t)((values[i] - low) * scale);
    counts[b < bins ? b : bins - 1] += 1;
  }
}

/* Partially sorts n values such that value k is in its sorted place, with no larger one before it
 * and no smaller one after it (Wirth 1976, Algorithms + Data Structures, section 2.3.4). */
static void select_nth(double *values, long n, long k) {
  for (long low = 0, high = n - 1; low < high;) {
    const double pivot = values[k];
    long i = low, j = high;
    do {
      while (values[i] < pivot) i++;
      while (pivot < values[j]) j--;
      if (i > j) break;
      const double left = values[i];
      values[i++] = values[j];
      values[j--] = left;
    } while (i <= j);
    if (j < k) low = i;
    if (k < i) high = j;
  }
}

enum status quantile_find(const double *values, size_t n, double q, double *result) {
  *result = n > 0 ? quantile(values, n, q) : 0.0;
  return n > 0 && isnan(*result) ? FAIL(STATUS_RUN, "memory is short for %zu values", n)
                                 : STATUS_OK;
}

double quantile(const double *values, size_t n, double q) {
  double *copy;
  if (n == 0) return NAN;
  if (memory_allocate(&copy, n, sizeof *copy, "a copy") != STATUS_OK) {
    error_clear();
    return NAN;
  }
  memcpy(copy, values, n * sizeof *copy);
  const double position = q * (double)(n - 1);
  const size_t i = (size_t)position;
  select_nth(copy, (long)n, (long)i);
  double next = i + 1 < n ? copy[i + 1] : copy[i];
  for (size_t k = i + 2; k < n; k++) next = fmin(next, copy[k]);
  const double result = copy[i] + (position - (double)i) * (next - copy[i]);
  memory_free(&copy);
  return result;
}
