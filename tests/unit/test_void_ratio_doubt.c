/* A measured void ratio beside the one that the scan itself shows. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "ct2model/misfit.h"
#include "ct2model/request.h"
#include "ct2model/state.h"

static double doubt(double measured, double error, double scan, double scan_error,
                    enum threshold_rule rule) {
  static struct pipeline pipeline;
  const struct request request = {.void_ratio = measured, .void_ratio_error = error, .rule = rule};
  pipeline =
      (struct pipeline){.request = &request,
                        .void_ratio_original = measured,
                        .restored = {.scan_void_ratio = scan, .scan_void_ratio_error = scan_error}};
  return misfit_void_ratio_doubt(&pipeline);
}

/* Within what both allow nothing is doubted; beyond, all of the difference is. */
static void test_doubt(void **state) {
  (void)state;
  assert_true(doubt(0.80, NAN, 0.78, 0.03, THRESHOLD_AUTO) == 0.0);
  assert_true(fabs(doubt(0.80, NAN, 0.76, 0.03, THRESHOLD_AUTO) - 0.04) < 1e-12);
  assert_true(fabs(doubt(0.70, NAN, 0.76, 0.03, THRESHOLD_AUTO) - 0.06) < 1e-12);
  assert_true(doubt(0.80, 0.03, 0.76, 0.03, THRESHOLD_AUTO) == 0.0); /* hypot: 0.042 */
  assert_true(fabs(doubt(0.80, 0.02, 0.76, 0.03, THRESHOLD_AUTO) - 0.04) < 1e-12);
}

static void test_unknown(void **state) {
  (void)state;
  assert_true(isnan(doubt(0.80, NAN, NAN, NAN, THRESHOLD_AUTO)));
  assert_true(isnan(doubt(0.80, NAN, 0.5, 0.01, THRESHOLD_OTSU)));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_doubt), cmocka_unit_test(test_unknown)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
