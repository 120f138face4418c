/* Steady point and mean of histories whose answers are known. */
#include "analyze/averaging.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#define ROWS 400
static double times[ROWS], values[ROWS];

static double noise(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0 - 0.5;
}

static void test_start_up_is_dropped(void **state) {
  (void)state;
  uint64_t seed = 1;
  struct average average;
  for (int i = 0; i < ROWS; i++) {
    times[i] = 1e-3 * i;
    values[i] = 2.0 * (1.0 - exp(-i / 20.0)) * (1.0 + 0.02 * noise(&seed));
  }
  assert_int_equal(average_record(times, values, ROWS, &average), STATUS_OK);
  assert_true(average.without_drift);
  assert_in_range(average.first, 60, 200); /* exp(-3) of 2 is above the noise before 60 */
  assert_true(fabs(average.mean - 2.0) < 0.003);
  assert_true(fabs(average.mean - 2.0) <= 2.0 * average.error95);
}

static void test_drift_is_not_steady(void **state) {
  (void)state;
  struct average average;
  for (int i = 0; i < ROWS; i++) {
    times[i] = i;
    values[i] = exp(i / 60.0); /* a run that blows up */
  }
  assert_int_equal(average_record(times, values, ROWS, &average), STATUS_OK);
  assert_false(average.without_drift);
}

/* The error is the larger of Student's t of the batches, less one, times the standard error, and of
 * the drift. */
static void test_error_of_the_mean(void **state) {
  (void)state;
  static const double t95[3] = {2.1098, 2.1009, 2.0930}; /* of 17, 18 and 19 degrees of freedom */
  uint64_t seed = 1;
  struct average average;
  for (int i = 0; i < ROWS; i++) {
    times[i] = i;
    values[i] = 2.0 + noise(&seed);
  }
  assert_int_equal(average_record(times, values, ROWS, &average), STATUS_OK);
  const int batches = (int)floor(sqrt((double)average.rows));
  assert_in_range(batches, 18, 20);
  assert_true(fabs(average.drift) < average.error95);
  assert_true(fabs(average.error95 / average.standard_error - t95[batches - 18]) < 2e-3);
  for (int i = 0; i < ROWS; i++) values[i] = 2.0 + 1e-4 * i;
  assert_int_equal(average_record(times, values, ROWS, &average), STATUS_OK);
  assert_true(fabs(average.drift - 0.5e-4 * (double)average.rows) < 2e-4);
  assert_true(average.error95 >= average.drift);
}

/* Rows that crowd where the value is high must not pull the mean. */
static void test_uneven_rows_are_weighted_by_time(void **state) {
  (void)state;
  struct average average;
  double t = 0.0;
  for (int i = 0; i < ROWS; i++) {
    double phase = fmod(t, 1.0);
    values[i] = phase < 0.5 ? 1.0 : 3.0;
    times[i] = t;
    t += phase < 0.5 ? 0.05 : 0.01;
  }
  assert_int_equal(average_record(times, values, ROWS, &average), STATUS_OK);
  assert_true(fabs(average.mean - 2.0) < 0.15); /* a plain mean gives 2.67 */
}

static void test_few_rows(void **state) {
  (void)state;
  struct average average;
  values[0] = 5.0;
  times[0] = 0.0;
  assert_int_equal(average_record(times, values, 1, &average), STATUS_OK);
  assert_true(average.mean == 5.0);
  assert_false(average.without_drift);
  assert_true(isnan(average.error95));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_start_up_is_dropped), cmocka_unit_test(test_error_of_the_mean),
      cmocka_unit_test(test_drift_is_not_steady),
      cmocka_unit_test(test_uneven_rows_are_weighted_by_time), cmocka_unit_test(test_few_rows)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
