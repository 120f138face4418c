/* First passage times of the advection-dispersion equation. */
#include <math.h>

#include "analyze/breakthrough.h"

#define ROUNDS 60
#define LEAST_TIMES 10

/* exp(x^2) erfc(x) without overflow; beyond 20 by the first terms of its asymptotic series. */
static double scaled_erfc(double x) {
  if (x < 20) return exp(x * x) * erfc(x);
  const double y = 1 / (x * x);
  return 0.5641895835477563 / x * (1 - 0.5 * y * (1 - 1.5 * y));
}

double breakthrough_share(double v, double d, double t) {
  if (!(t > 0)) return 0;
  const double spread = sqrt(4 * d * t), a = (1 - v * t) / spread, b = (1 + v * t) / spread;
  return 0.5 * (erfc(a) + exp(-a * a) * scaled_erfc(b)); /* v / D = b^2 - a^2 */
}

double breakthrough_time(double v, double d, double share) {
  double low = 0, high = 1 / v;
  for (int i = 0; i < 200 && breakthrough_share(v, d, high) < share; i++) high *= 2;
  for (int i = 0; i < 100; i++) {
    const double middle = 0.5 * (low + high);
    *(breakthrough_share(v, d, middle) < share ? &low : &high) = middle;
  }
  return 0.5 * (low + high);
}

static double residual_sum(const double *t, const double *share, size_t n, double v, double d) {
  double sum = 0;
  for (size_t i = 0; i < n; i++)
    if (isfinite(t[i])) sum += pow(breakthrough_share(v, d, t[i]) - share[i], 2);
  return sum;
}

/* One step of the Levenberg-Marquardt method in ln v and ln D. */
static void levenberg_step(const double *t, const double *share, size_t n, double v, double d,
                           double damping, double step[2]) {
  const double h = 1e-5;
  double a[3] = {0}, r[2] = {0};
  for (size_t i = 0; i < n; i++) {
    if (!isfinite(t[i])) continue;
    const double left = share[i] - breakthrough_share(v, d, t[i]);
    const double by_v =
        (breakthrough_share(v * (1 + h), d, t[i]) - breakthrough_share(v * (1 - h), d, t[i])) /
        (2 * h);
    const double by_d =
        (breakthrough_share(v, d * (1 + h), t[i]) - breakthrough_share(v, d * (1 - h), t[i])) /
        (2 * h);
    a[0] += by_v * by_v, a[1] += by_v * by_d, a[2] += by_d * by_d;
    r[0] += by_v * left, r[1] += by_d * left;
  }
  a[0] *= 1 + damping, a[2] *= 1 + damping;
  const double determinant = a[0] * a[2] - a[1] * a[1];
  step[0] = step[1] = 0;
  if (!(determinant > 0)) return;
  step[0] = fmax(-1, fmin(1, (r[0] * a[2] - r[1] * a[1]) / determinant));
  step[1] = fmax(-1, fmin(1, (r[1] * a[0] - r[0] * a[1]) / determinant));
}

bool breakthrough_fit(const double *t, const double *share, size_t n, double *v, double *d,
                      double *misfit) {
  size_t count = 0;
  double sum = 0, square = 0, damping = 1e-3;
  for (size_t i = 0; i < n; i++)
    if (isfinite(t[i])) count++, sum += t[i], square += t[i] * t[i];
  if (count < LEAST_TIMES) return false;
  /* Moments of the first passage times: mean 1 / v, variance 2 D / v^3. */
  const double mean = sum / (double)count, variance = square / (double)count - mean * mean;
  *v = 1 / mean, *d = fmax(0.5 * variance / (mean * mean * mean), 1e-6 / mean);
  double now = residual_sum(t, share, n, *v, *d);
  for (int round = 0; round < ROUNDS && damping < 1e8; round++) {
    double step[2];
    levenberg_step(t, share, n, *v, *d, damping, step);
    const double next = residual_sum(t, share, n, *v * exp(step[0]), *d * exp(step[1]));
    if (!(next < now)) {
      damping *= 10;
      continue;
    }
    *v *= exp(step[0]), *d *= exp(step[1]);
    now = next, damping *= 0.2;
    if (hypot(step[0], step[1]) < 1e-9) break;
  }
  *misfit = 0;
  for (size_t i = 0; i < n; i++)
    if (isfinite(t[i])) *misfit = fmax(*misfit, fabs(breakthrough_share(*v, *d, t[i]) - share[i]));
  return true;
}
