#include "common/convergence.h"

#include <math.h>

/* Least squares of f = value + slope h^p at given p; returns the sum of squares left. */
static double fit_power(const double *h, const double *f, size_t n, double p, double *value,
                        double *slope) {
  double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0, left = 0.0;
  for (size_t i = 0; i < n; i++) {
    mx += pow(h[i] / h[0], p) / (double)n;
    my += f[i] / (double)n;
  }
  for (size_t i = 0; i < n; i++) {
    double x = pow(h[i] / h[0], p) - mx;
    xx += x * x;
    xy += x * (f[i] - my);
  }
  double b = xy / xx;
  *value = my - b * mx;
  *slope = b / pow(h[0], p);
  for (size_t i = 0; i < n; i++) {
    double d = f[i] - *value - b * pow(h[i] / h[0], p);
    left += d * d;
  }
  return left;
}

/* The order in [0.05, 10] that leaves least: a coarse scan, then golden section. */
static double best_order(const double *h, const double *f, size_t n) {
  const double step = 0.05, golden = 0.6180339887498949;
  double value, slope, best = step, least = INFINITY;
  for (int i = 1; i <= 200; i++) {
    double p = i * step, left = fit_power(h, f, n, p, &value, &slope);
    if (left < least) {
      least = left;
      best = p;
    }
  }
  double low = fmax(best - step, 0.01), high = best + step;
  while (high - low > 1e-7) {
    double a = high - golden * (high - low), b = low + golden * (high - low);
    if (fit_power(h, f, n, a, &value, &slope) < fit_power(h, f, n, b, &value, &slope))
      high = b;
    else
      low = a;
  }
  return 0.5 * (low + high);
}

void converge_extrapolate(const double *h, const double *f, size_t n, double formal_order,
                          struct convergence *result) {
  double low = f[0], high = f[0];
  bool rising = true, falling = true;
  *result = (struct convergence){.order = NAN, .order_used = formal_order, .safety = 3.0};
  for (size_t i = 1; i < n; i++) {
    low = fmin(low, f[i]);
    high = fmax(high, f[i]);
    rising = rising && f[i] >= f[i - 1];
    falling = falling && f[i] <= f[i - 1];
  }
  result->monotone = rising || falling;
  if (n > 2 && !result->monotone) {
    result->value = f[0];
    result->index = 3.0 * (high - low) / fabs(f[0]);
    return;
  }
  if (n > 2) {
    result->order = best_order(h, f, n);
    bool close = fabs(result->order - formal_order) <= 0.1 * formal_order;
    result->credible = fabs(result->order - formal_order) <= 0.5 * formal_order;
    result->safety = close ? 1.25 : 3.0;
    /* Faster than the formal order the finest is nearly there, and the observed one says so. */
    result->order_used = fmax(result->order, 0.5);
  }
  /* Off the credible range only the two finest speak, as they lie nearest to the limit. */
  bool all = n > 2 && result->credible;
  fit_power(h, f, all ? n : 2, result->order_used, &result->value, &result->slope);
  /* A value beyond zero, or moved by more than half, is no value: the finest stands. */
  if (!(fabs(result->value - f[0]) <= 0.5 * fabs(f[0]))) {
    result->far = true;
    result->credible = false;
    result->safety = 3.0;
    result->value = f[0];
    result->slope = 0.0;
    result->index = 3.0 * fabs((f[1] - f[0]) / f[0]);
    return;
  }
  /* Hardly an order at all: the limit could be anywhere, so the finest stands. */
  if (n > 2 && result->order < 0.5) {
    result->far = true;
    result->value = f[0];
    result->slope = 0.0;
  }
  double p =
      result->safety < 3.0 || n == 2 ? formal_order : fmin(fmax(result->order, 0.5), formal_order);
  double ratio = pow(h[1] / h[0], p);
  result->index = result->safety * fabs((f[1] - f[0]) / f[0]) / (ratio - 1.0);
}

/* Least squares of f = value + slope h^p over the finest n, each by 1/h^p: what is left of higher
 * orders grows with h. */
static double fit_limit(const double *h, const double *f, size_t n, double p) {
  double weight = 0.0, mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0;
  for (size_t i = 0; i < n; i++) {
    const double x = pow(h[i] / h[0], p), w = 1.0 / x;
    weight += w;
    mx += w * x;
    my += w * f[i];
  }
  mx /= weight, my /= weight;
  for (size_t i = 0; i < n; i++) {
    const double x = pow(h[i] / h[0], p), w = 1.0 / x;
    xx += w * (x - mx) * (x - mx);
    xy += w * (x - mx) * (f[i] - my);
  }
  return my - xy / xx * mx;
}

#define LIMIT_WINDOW 3
#define LIMIT_STEP 0.6
#define LIMIT_FINEST 0.15

void converge_limit(const double *h, const double *f, size_t n, double formal_order,
                    struct limit_estimate *limit) {
  *limit = (struct limit_estimate){f[0], NAN, NAN, NAN};
  if (n < 2) return;
  const size_t window = n < LIMIT_WINDOW ? n : LIMIT_WINDOW;
  limit->value = fit_limit(h, f, window, formal_order);
  if (n > 2) limit->order = best_order(h, f, 3);
  double bound = fabs(f[0] - limit->value);
  if (n > 2) {
    const size_t before = n - 1 < LIMIT_WINDOW ? n - 1 : LIMIT_WINDOW;
    const double last = fit_limit(h + 1, f + 1, before, formal_order);
    bound = hypot(LIMIT_STEP * (limit->value - last), LIMIT_FINEST * (f[0] - limit->value));
  }
  limit->low = limit->high = bound / fabs(limit->value);
}
