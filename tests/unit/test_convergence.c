/* Extrapolation of data whose limit and order are known. */
#include "common/convergence.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

static const double h[4] = {1.0, 1.7, 2.0, 4.0};

static void make(double order, double *f) {
  for (int i = 0; i < 4; i++) f[i] = 3.0 + 0.02 * pow(h[i], order);
}

static void test_order_and_limit_are_exact(void **state) {
  (void)state;
  double f[4];
  struct convergence c;
  for (size_t n = 3; n <= 4; n++) {
    make(2.0, f);
    converge_extrapolate(h, f, n, 2.0, &c);
    assert_true(fabs(c.order - 2.0) < 1e-4 && fabs(c.value - 3.0) < 1e-6);
    assert_true(c.credible && c.safety == 1.25);
    /* The index is 1.25 times the finest value's true error. */
    assert_true(fabs(c.index - 1.25 * 0.02 / f[0]) < 1e-6);
  }
}

static void test_order_off_the_formal_one_widens_the_error(void **state) {
  (void)state;
  double f[4];
  struct convergence c;
  make(1.2, f); /* still credible, extrapolated with its own order */
  converge_extrapolate(h, f, 3, 2.0, &c);
  assert_true(c.credible && c.safety == 3.0 && fabs(c.value - 3.0) < 1e-5);
  assert_true(c.index > fabs(f[0] - 3.0) / f[0]);
  make(0.3, f);
  converge_extrapolate(h, f, 3, 2.0, &c);
  assert_false(c.credible);
  assert_true(c.far && c.value == f[0]); /* no limit to be seen */
  make(5.0, f);
  converge_extrapolate(h, f, 3, 2.0, &c);
  assert_false(c.credible);
  assert_true(fabs(c.value - 3.0) < 1e-5); /* the observed order finds it */
  assert_true(c.index > fabs(f[0] - 3.0) / f[0]);
}

static void test_two_spacings_take_the_formal_order(void **state) {
  (void)state;
  double f[4];
  struct convergence c;
  make(2.0, f);
  converge_extrapolate(h, f, 2, 2.0, &c);
  assert_true(isnan(c.order) && fabs(c.value - 3.0) < 1e-12 && !c.credible);
  assert_true(fabs(c.index - 3.0 * 0.02 / f[0]) < 1e-12);
}

static void test_oscillation_gives_no_order(void **state) {
  (void)state;
  const double f[3] = {1.0, 1.1, 0.95};
  struct convergence c;
  converge_extrapolate(h, f, 3, 2.0, &c);
  assert_false(c.monotone || c.credible);
  assert_true(c.value == 1.0 && isnan(c.order) && fabs(c.index - 0.45) < 1e-12);
}

static void test_too_coarse_is_not_extrapolated(void **state) {
  (void)state;
  const double f[2] = {1.0, 1.9}, coarse[2] = {3.0, 4.0};
  struct convergence c;
  converge_extrapolate(coarse, f, 2, 2.0, &c); /* would give -0.16 */
  assert_true(c.far && !c.credible && c.value == 1.0 && fabs(c.index - 2.7) < 1e-12);
}

/* The sample sand's true grains, 47 to 5.8 um: .0277 cm/s. From five lattices and from four the
 * estimate is within a third of what the finest is off, and the error holds it. */
static void test_limit_of_a_sand(void **state) {
  (void)state;
  const double k[5] = {.0298, .0319, .0354, .0423, .0553}, limit = .0277;
  double spacing[5];
  for (int i = 0; i < 5; i++) spacing[i] = 46.64 * pow(2.0, 0.5 * (i - 4));
  for (int first = 0; first < 2; first++) {
    struct limit_estimate l;
    converge_limit(spacing + first, k + first, 5 - (size_t)first, 46.64, 25.0, &l);
    const double off = l.value / limit - 1.0;
    assert_true(fabs(off) < (first == 0 ? .01 : .025));
    assert_true(fabs(off) < fmin(l.low, l.high));
    assert_true(l.high < (first == 0 ? .065 : .1));
  }
}

/* A smooth body, whose error falls with the fourth power: not a sand's limit below the finest. */
static void test_limit_of_a_smooth_body(void **state) {
  (void)state;
  double spacing[4], k[4];
  for (int i = 0; i < 4; i++) {
    spacing[i] = pow(2.0, 0.5 * i);
    k[i] = 1.0 + 0.005 * pow(spacing[i], 4.0);
  }
  struct limit_estimate l;
  converge_limit(spacing, k, 4, 4.0, 4.0, &l);
  assert_true(fabs(l.value - 1.0) < .005 && fabs(l.value - 1.0) < l.high && l.order > 2.5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_order_and_limit_are_exact),
      cmocka_unit_test(test_order_off_the_formal_one_widens_the_error),
      cmocka_unit_test(test_two_spacings_take_the_formal_order),
      cmocka_unit_test(test_oscillation_gives_no_order),
      cmocka_unit_test(test_too_coarse_is_not_extrapolated),
      cmocka_unit_test(test_limit_of_a_sand),
      cmocka_unit_test(test_limit_of_a_smooth_body)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
