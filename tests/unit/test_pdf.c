/* Densities and their references. */
#include "analyze/pdf.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#define N 20000
static double values[N];

static double integral(const struct pdf *pdf) {
  double sum = 0.0;
  for (size_t i = 0; i < pdf->bins; i++)
    sum += pdf->density[i] * (pdf->edges[i + 1] - pdf->edges[i]);
  return sum;
}

/* Slit: s = 6 y (1 - y) for y even in the gap follows pdf_slit. */
static void test_slit_flow_follows_its_density(void **state) {
  (void)state;
  struct pdf pdf;
  for (int i = 0; i < N; i++) {
    double y = (i + 0.5) / N;
    values[i] = 6.0 * y * (1.0 - y);
  }
  assert_int_equal(pdf_estimate(values, N, &pdf), STATUS_OK);
  assert_true(fabs(integral(&pdf) - 1.0) < 1e-12);
  for (size_t i = 0; i < pdf.bins; i++) {
    double s = 0.5 * (pdf.edges[i] + pdf.edges[i + 1]);
    if (s > 0.05 && s < 1.35) assert_true(fabs(pdf.density[i] / pdf_slit(s) - 1.0) < 0.03);
  }
  pdf_free(&pdf);
}

static void test_references_have_unit_integral_and_mean(void **state) {
  (void)state;
  double (*const reference[])(double) = {pdf_slit, pdf_tube, pdf_exponential};
  for (int r = 0; r < 3; r++) {
    double sum = 0.0, mean = 0.0;
    const double ds = 1e-5;
    for (double s = 0.5 * ds; s < 30.0; s += ds) {
      sum += reference[r](s) * ds;
      mean += s * reference[r](s) * ds;
    }
    assert_true(fabs(sum - 1.0) < 2e-3); /* the slit's singularity at 1.5 */
    assert_true(fabs(mean - 1.0) < 2e-3);
  }
}

static void test_power_exponential_is_found(void **state) {
  (void)state;
  double sigma, gamma;
  for (int i = 0; i < N; i++) values[i] = -log((i + 0.5) / N); /* exponential: gamma = sigma = 1 */
  pdf_fit_power_exponential(values, N, &sigma, &gamma);
  assert_true(fabs(gamma - 1.0) < 0.02 && fabs(sigma - 1.0) < 0.03);
}

static void test_moments(void **state) {
  (void)state;
  struct moments m;
  for (int i = 0; i < N; i++) values[i] = -log((i + 0.5) / N);
  moments_of(values, N, &m);
  assert_true(fabs(m.mean - 1.0) < 1e-3 && fabs(m.standard_deviation - 1.0) < 5e-3);
  assert_true(fabs(m.skewness - 2.0) < 0.05 && fabs(m.excess_kurtosis - 6.0) < 0.5);
}

static void test_one_value(void **state) {
  (void)state;
  struct pdf pdf;
  for (int i = 0; i < 100; i++) values[i] = 1.0;
  assert_int_equal(pdf_estimate(values, 100, &pdf), STATUS_OK);
  assert_true(fabs(integral(&pdf) - 1.0) < 1e-9);
  pdf_free(&pdf);
}

/* Freedman and Diaconis (1981): bins of 2 IQR / cbrt(n), for values even in [0, 1] 1 / cbrt(n). */
static void test_bins(void **state) {
  (void)state;
  struct pdf pdf;
  for (int i = 0; i < N; i++) values[i] = (double)i / (N - 1);
  assert_int_equal(pdf_estimate(values, N, &pdf), STATUS_OK);
  assert_int_equal(pdf.bins, (size_t)ceil(cbrt(N)));
  pdf_free(&pdf);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_slit_flow_follows_its_density),
                                     cmocka_unit_test(test_references_have_unit_integral_and_mean),
                                     cmocka_unit_test(test_power_exponential_is_found),
                                     cmocka_unit_test(test_moments),
                                     cmocka_unit_test(test_one_value),
                                     cmocka_unit_test(test_bins)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
