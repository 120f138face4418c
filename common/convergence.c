#include "common/convergence.h"

#include <math.h>

#include "common/constants.h"

/* Least squares fit of f = value + slope h^p for a given p; returns the sum of the squared
 * residuals. */
static double fit_power(const double *h, const double *f, size_t n, double p, double *value,
                        double *slope) {
  double mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0, residual = 0.0;
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
    residual += d * d;
  }
  return residual;
}

/* The order in [0.05, 10] with the least residual, by a coarse scan followed by a golden section
 * search. */
static double best_order(const double *h, const double *f, size_t n) {
  const double step = ORDER_STEP, golden = GOLDEN_SECTION;
  double value, slope, best = step, least = INFINITY;
  for (int i = 1; i <= 200; i++) {
    double p = i * step, residual = fit_power(h, f, n, p, &value, &slope);
    if (residual < least) {
      least = residual;
      best = p;
    }
  }
  double low = fmax(best - step, ORDER_LEAST), high = best + step;
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
  *result = (struct convergence){.order = NAN, .order_used = formal_order, .safety = SAFETY_FAR};
  for (size_t i = 1; i < n; i++) {
    low = fmin(low, f[i]);
    high = fmax(high, f[i]);
    rising = rising && f[i] >= f[i - 1];
    falling = falling && f[i] <= f[i - 1];
  }
  result->monotone = rising || falling;
  if (h[n - 1] < SPACING_RATIO_MIN * h[0]) {
    result->near = result->far = true;
    result->value = f[0];
    result->index = 1.0;
    return;
  }
  if (n > 2 && !result->monotone) {
    result->value = f[0];
    result->index = SAFETY_FAR * (high - low) / fabs(f[0]);
    return;
  }
  if (n > 2) {
    result->order = best_order(h, f, n);
    bool close = fabs(result->order - formal_order) <= ORDER_CLOSE * formal_order;
    result->credible = fabs(result->order - formal_order) <= 0.5 * formal_order;
    result->safety = close ? SAFETY_CLOSE : SAFETY_FAR;
    /* An observed order above the formal one is used as it is: the finest value is then close to
     * the limit. */
    result->order_used = fmax(result->order, 0.5);
  }
  /* Outside the credible range of orders only the two finest values are used, as they are nearest
   * to the limit. */
  bool all = n > 2 && result->credible;
  fit_power(h, f, all ? n : 2, result->order_used, &result->value, &result->slope);
  /* An extrapolation that changes the value by more than half is not credible: the finest value is
   * kept. */
  if (!(fabs(result->value - f[0]) <= 0.5 * fabs(f[0]))) {
    result->far = true;
    result->credible = false;
    result->safety = 3.0;
    result->value = f[0];
    result->slope = 0.0;
    result->index = 3.0 * fabs((f[1] - f[0]) / f[0]);
    return;
  }
  /* With such a low order the limit is undetermined: the finest value is kept. */
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

/* Estimate of the limit by Bayesian model averaging (Hoeting et al. 1999, Statistical Science 14).
 * The order is unknown and obscured by scatter from the positions of the sites. Therefore k = value
 * + slope h^p is fitted for a range of orders, and each fit is weighted by its likelihood and the
 * prior probability of its order. The prior is the sum of two normal distributions, because two
 * kinds of bodies are equally likely: grains with edges and contacts, whose k converges with an
 * order slightly below two, and smooth bodies, where errors of opposite sign cancel and higher
 * orders are observed. A single normal distribution between the two fits neither. The constants
 * were calibrated on sands, spheres, cylinders and fibres (docs/physics/error-of-k.md). */
#define LIMIT_VALUES_MAX 4

struct limit_fit {
  double value, variance, residual, evidence; /* evidence: logarithm of the weight */
};

static double normal_density(double x, double mean, double spread) {
  const double off = (x - mean) / spread;
  return exp(-0.5 * off * off) / spread;
}

/* Prior probability of an order, not normalised. */
static double order_expected(double p) {
  return normal_density(p, LIMIT_GRAINS_ORDER, LIMIT_GRAINS_SPREAD) +
         normal_density(p, LIMIT_SMOOTH_ORDER, LIMIT_SMOOTH_SPREAD);
}

static struct limit_fit fit_order(const double *h, const double *f, const double *weight, size_t n,
                                  double p) {
  double sum = 0.0, mx = 0.0, my = 0.0, xx = 0.0, xy = 0.0, residual = 0.0, x[LIMIT_VALUES_MAX];
  for (size_t i = 0; i < n; i++) {
    x[i] = pow(h[i] / h[0], p);
    sum += weight[i];
    mx += weight[i] * x[i];
    my += weight[i] * f[i];
  }
  mx /= sum, my /= sum;
  for (size_t i = 0; i < n; i++) {
    xx += weight[i] * (x[i] - mx) * (x[i] - mx);
    xy += weight[i] * (x[i] - mx) * (f[i] - my);
  }
  const double slope = xy / xx, value = my - slope * mx;
  for (size_t i = 0; i < n; i++)
    residual += weight[i] * (f[i] - value - slope * x[i]) * (f[i] - value - slope * x[i]);
  return (struct limit_fit){value, 1.0 / sum + mx * mx / xx, residual,
                            -0.5 * residual + log(order_expected(p))};
}

void converge_limit(const double *h, const double *f, size_t n, double scale, double across,
                    struct limit_estimate *limit) {
  struct limit_fit fits[LIMIT_ORDERS];
  double weight[LIMIT_VALUES_MAX], best = -INFINITY, total = 0.0, mean = 0.0, square = 0.0;
  double order = 0.0, largest_difference = 0.0, residual = INFINITY;
  *limit = (struct limit_estimate){f[0], NAN, NAN, NAN};
  if (n < 2) return;
  const size_t window = n < LIMIT_VALUES_MAX ? n : LIMIT_VALUES_MAX;
  for (size_t i = 0; i < window; i++) {
    largest_difference = fmax(largest_difference, fabs(f[i] - f[0]));
    const double change = LIMIT_NOISE_CHANGE * largest_difference;
    const double own = fmax(LIMIT_NOISE_VALUE * h[i] / scale, 1e-9) * f[0];
    weight[i] = 1.0 / (change * change + own * own);
  }
  for (int p = 0; p < LIMIT_ORDERS; p++) {
    fits[p] = fit_order(h, f, weight, window, LIMIT_ORDER_FIRST + LIMIT_ORDER_STEP * p);
    best = fmax(best, fits[p].evidence);
    residual = fmin(residual, fits[p].residual);
  }
  for (int p = 0; p < LIMIT_ORDERS; p++) {
    const double share = exp(fits[p].evidence - best);
    total += share;
    mean += share * fits[p].value;
    order += share * (LIMIT_ORDER_FIRST + LIMIT_ORDER_STEP * p);
  }
  mean /= total;
  /* If the values scatter more than their assumed standard deviations, the variance is enlarged by
   * the Birge ratio (Birge 1932, Phys. Rev. 40). This happens with regular grains whose narrow gaps
   * contain sites on some lattices and not on others. */
  const double scatter = window > 2 ? fmax(residual / (double)(window - 2), 1.0) : 1.0;
  for (int p = 0; p < LIMIT_ORDERS; p++) {
    const double off = fits[p].value - mean;
    square += exp(fits[p].evidence - best) * (off * off + scatter * fits[p].variance) / total;
  }
  limit->order = order / total;
  /* An extrapolation to less than half of the finest value is not credible. */
  if (!(mean > 0.5 * f[0])) {
    limit->value = f[0];
    limit->low = 1.0 - fmax(mean, 0.0) / f[0];
    limit->high = LIMIT_COVERAGE * LIMIT_NOISE_VALUE * h[0] / scale;
    limit->low = fmax(limit->low, limit->high);
    return;
  }
  /* With two or three values the caller enlarges the whole error (cascade_few_lattices). */
  const double few_pores = window == LIMIT_VALUES_MAX ? LIMIT_STEP_PORES / fmax(across, 1.0) : 0.0;
  const double share = fmin(fmax(few_pores, LIMIT_STEP_MIN), LIMIT_STEP_MAX);
  const double bound = LIMIT_COVERAGE * hypot(sqrt(square), share * (f[0] - mean));
  limit->value = mean;
  limit->low = fmin(1.0, bound / mean);
  limit->high = bound / mean;
}
