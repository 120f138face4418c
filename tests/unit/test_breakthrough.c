/* First passages by the advection-dispersion equation: limits, inverse, fit. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "analyze/breakthrough.h"

/* Integral of the inverse Gaussian density exp(-(1 - v t)^2 / (4 D t)) / sqrt(4 pi D t^3). */
static double integrated(double v, double d, double t) {
  enum { STEPS = 20000 };
  double sum = 0;
  for (int i = 0; i < STEPS; i++) {
    const double s = t * (i + 0.5) / STEPS;
    sum += exp(-pow(1 - v * s, 2) / (4 * d * s)) / sqrt(4 * M_PI * d * s * s * s) * t / STEPS;
  }
  return sum;
}

static void test_share(void **state) {
  (void)state;
  static const double v[] = {0.5, 1, 2}, d[] = {1e-3, 0.03, 1, 20};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 4; j++)
      for (double t = 0.3; t < 4; t *= 1.7) {
        const double share = breakthrough_share(v[i], d[j], t);
        assert_true(fabs(share - integrated(v[i], d[j], t)) < 2e-4);
        if (share > 1e-6 && share < 1 - 1e-6)
          assert_true(fabs(breakthrough_time(v[i], d[j], share) / t - 1) < 1e-6);
      }
  assert_true(breakthrough_share(1, 1e-6, 0.5) == 0);
  assert_true(fabs(breakthrough_share(1, 1e-6, 2) - 1) < 1e-12);
}

static void test_fit(void **state) {
  (void)state;
  enum { N = 200 };
  double t[N], share[N], v, d, misfit;
  for (int q = 0; q < N; q++) share[q] = (q + 0.5) / N;
  for (double spread = 1e-3; spread < 2; spread *= 5) {
    /* The last fifth has not passed yet. */
    for (int q = 0; q < N; q++)
      t[q] = q < 160 ? breakthrough_time(1.1, spread, share[q]) : (double)NAN;
    assert_true(breakthrough_fit(t, share, N, &v, &d, &misfit));
    assert_true(fabs(v / 1.1 - 1) < 1e-5 && fabs(d / spread - 1) < 1e-4 && misfit < 1e-6);
  }
  /* A tail that it cannot make: two speeds. */
  for (int q = 0; q < N; q++)
    t[q] = breakthrough_time(q < 150 ? 1.5 : 0.3, 0.01,
                             q < 150 ? q / 150.0 + 0.003 : (q - 149.5) / 50.0);
  assert_true(breakthrough_fit(t, share, N, &v, &d, &misfit));
  assert_true(misfit > 0.05);
  for (int q = 9; q < N; q++) t[q] = (double)NAN;
  assert_false(breakthrough_fit(t, share, N, &v, &d, &misfit));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_share), cmocka_unit_test(test_fit)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
