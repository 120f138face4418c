/* Fits of Darcy's law to data whose k and b are known. */
#include "analyze/darcy.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/units.h"

#define N 5
static const double gradient[N] = {1, 2, 5, 8, 10};
static const double scatter[N] = {0.004, -0.006, 0.003, -0.002, 0.001}; /* relative */
static const double nu = 1e-6;

static void fit_quadratic(double k, double b, double amount, struct darcy_fit *fit) {
  double v[N], error[N];
  for (int i = 0; i < N; i++) {
    v[i] = b > 0 ? 2.0 * gradient[i] / (1.0 / k + sqrt(1.0 / (k * k) + 4.0 * b * gradient[i]))
                 : k * gradient[i];
    v[i] *= 1.0 + amount * scatter[i];
    error[i] = 0.001 * v[i];
  }
  assert_int_equal(darcy_fit(gradient, v, error, N, nu, GRAVITY_STANDARD, fit), STATUS_OK);
}

static void test_line(void **state) {
  (void)state;
  struct darcy_fit fit;
  fit_quadratic(1.54e-3, 0.0, 1.0, &fit);
  assert_true(fabs(fit.k / 1.54e-3 - 1.0) < 0.003);
  assert_true(fabs(fit.k - 1.54e-3) <= fit.k_error);
  assert_true(fit.k_error < 0.01 * fit.k);
  assert_true(fit.r_squared > 0.9999);
  assert_false(fit.forchheimer);
  assert_true(fabs(fit.intrinsic_permeability / (fit.k * nu / GRAVITY_STANDARD) - 1.0) < 1e-12);
}

static void test_forchheimer_when_called_for(void **state) {
  (void)state;
  struct darcy_fit fit;
  const double k = 2e-3, b = 20000.0; /* b v^2 is about a fifth of i = 10 */
  fit_quadratic(k, b, 1.0, &fit);
  assert_true(fit.forchheimer);
  assert_true(fabs(fit.k / k - 1.0) < 0.02);
  assert_true(fabs(fit.b - b) < fit.b_error);
  /* With scatter that drowns it, the term is not called for. */
  fit_quadratic(k, 200.0, 1.0, &fit);
  assert_false(fit.forchheimer);
}

/* Three runs leave one degree of freedom: their own errors tell what Student's t cannot. */
static void test_forchheimer_of_three_runs(void **state) {
  (void)state;
  struct darcy_fit fit;
  const double k = 2e-3, b = 1500.0, i[3] = {1, 5, 10}, off[3] = {0.003, -0.003, 0.0015};
  double v[3], error[3];
  for (int j = 0; j < 3; j++) {
    v[j] = (1.0 + off[j]) * 2.0 * i[j] / (1.0 / k + sqrt(1.0 / (k * k) + 4.0 * b * i[j]));
    error[j] = 0.005 * v[j];
  }
  assert_int_equal(darcy_fit(i, v, error, 3, nu, GRAVITY_STANDARD, &fit), STATUS_OK);
  assert_true(fit.forchheimer);
  assert_true(fabs(fit.b - b) < fit.b_error);
  assert_true(fabs(fit.k - k) < fit.k_error && fit.k_error < 0.02 * k);
  /* Errors that do not explain the residuals, or are not known, leave it to the scatter. */
  for (int j = 0; j < 3; j++) error[j] = 0.0002 * v[j];
  assert_int_equal(darcy_fit(i, v, error, 3, nu, GRAVITY_STANDARD, &fit), STATUS_OK);
  assert_false(fit.forchheimer);
  for (int j = 0; j < 3; j++) error[j] = NAN;
  assert_int_equal(darcy_fit(i, v, error, 3, nu, GRAVITY_STANDARD, &fit), STATUS_OK);
  assert_false(fit.forchheimer);
}

static void test_one_and_two_runs(void **state) {
  (void)state;
  struct darcy_fit fit;
  const double v[2] = {1e-3, 2.02e-3}, error[2] = {1e-5, 1e-5};
  assert_int_equal(darcy_fit(gradient, v, error, 1, nu, GRAVITY_STANDARD, &fit), STATUS_OK);
  assert_true(fabs(fit.k - 1e-3) < 1e-12 && fabs(fit.k_error - 1e-5) < 1e-12);
  assert_true(isnan(fit.r_squared) && isnan(fit.b));
  assert_int_equal(darcy_fit(gradient, v, error, 2, nu, GRAVITY_STANDARD, &fit), STATUS_OK);
  assert_true(fabs(fit.k - (1e-3 + 2 * 2.02e-3) / 5.0) < 1e-12);
  assert_true(fabs(fit.free_slope - 1.02e-3) < 1e-12);
}

/* The slope of a line through the origin is sum g v / sum g^2: errors of its points are in it as
 * sqrt(sum g^2 e^2) / sum g^2, their scatter, of n - 1 degrees of freedom, by Student's t. */
static void test_errors_of_a_line(void **state) {
  (void)state;
  struct darcy_fit fit;
  const double g[2] = {1.0, 3.0}, on_line[2] = {1e-3, 3e-3}, error[2] = {1e-5, 2e-5};
  assert_int_equal(darcy_fit(g, on_line, error, 2, nu, GRAVITY_STANDARD, &fit), STATUS_OK);
  assert_true(fabs(fit.k_error / (sqrt(1.0 + 9.0 * 4.0) / 10.0 * 1e-5) - 1.0) < 1e-9);
  /* off by (0.02, -0.01) k, which is across g: a standard error of 0.01 k, and t is 12.706 */
  const double h[2] = {1.0, 2.0}, off[2] = {1.02e-3, 1.99e-3}, none[2] = {0.0, 0.0};
  assert_int_equal(darcy_fit(h, off, none, 2, nu, GRAVITY_STANDARD, &fit), STATUS_OK);
  assert_true(fabs(fit.k_error / (0.12706 * 1e-3) - 1.0) < 1e-4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_line), cmocka_unit_test(test_forchheimer_when_called_for),
      cmocka_unit_test(test_forchheimer_of_three_runs), cmocka_unit_test(test_one_and_two_runs),
      cmocka_unit_test(test_errors_of_a_line)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
