/* The watchdog: what it takes for out of bounds, what it keeps, when it gives up. */
#include "sphsolve/march/watchdog.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "common/memory.h"
#include "sphsolve/output/step_log.h"

static void test_worst(void **state) {
  (void)state;
  double share;
  struct watch_reading reading = {{0.1, 0.4, 0.2, 0}};
  assert_int_equal(watchdog_worst(&reading, &share), WATCH_VELOCITY);
  assert_true(share == 0.4);
  reading.used[WATCH_ENERGY] = NAN;
  assert_int_equal(watchdog_worst(&reading, &share), WATCH_ENERGY);
  assert_true(share >= 1);
}

/* Free fall from rest and a body at constant speed use at most half of the energy's bound; a speed
 * that triples between looks leaves it. */
static void test_energy(void **state) {
  (void)state;
  struct watchdog fall = {0}, glide = {0};
  for (int k = 0; k < 100; k++) {
    double t = 0.01 * k;
    assert_true(watchdog_energy(&fall, 9.81 * t, t, 9.81, 0, 1e-9) <= 0.5 + 1e-12);
    assert_true(watchdog_energy(&glide, 3, t, 0, 0, 1e-9) <= 0.5 + 1e-12);
  }
  assert_true(watchdog_energy(&glide, 9, 1, 0, 0, 1e-9) > 1);
  /* Below the floor nothing is dangerous. */
  glide.speed = 1e-15;
  assert_true(watchdog_energy(&glide, 9e-15, 1.1, 0, 0, 1e-3) < 1);
}

static void test_three_halvings(void **state) {
  (void)state;
  struct watchdog dog = {0};
  assert_false(watchdog_trip(&dog, 1, 0)); /* nothing to go back to */
  assert_true(watchdog_wants(&dog, 0, 0.5));
  assert_false(watchdog_wants(&dog, 0, 1.0));
  watchdog_keep(&dog, 0, 0.5);
  assert_false(watchdog_wants(&dog, 8, 0.7)); /* on its way out */
  assert_true(watchdog_wants(&dog, 8, 0.1));
  for (int k = 1; k <= WATCH_BACKS; k++) {
    assert_true(watchdog_trip(&dog, k, (size_t)k - 1));
    assert_int_equal(dog.halvings, k);
  }
  assert_false(watchdog_trip(&dog, 9, WATCH_BACKS));
  dog.halvings = 0; /* the step has recovered: the count is the run's */
  assert_false(watchdog_trip(&dog, 9, WATCH_BACKS));
}

static void test_log_round_trip(void **state) {
  (void)state;
  char path[] = "/tmp/test_watchdog_XXXXXX";
  struct step_log log = {0}, read = {0};
  struct h5_file *file = NULL;
  close(mkstemp(path));
  for (int k = 0; k < 5; k++) step_log_limit(&log, k < 3 ? "sound" : "watchdog");
  assert_int_equal(step_log_back(&log, &(struct step_back){2, 1, 0.5, "density"}), STATUS_OK);
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(step_log_write(&log, file, "/run"), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  assert_int_equal(h5_open(path, &file), STATUS_OK);
  assert_int_equal(step_log_read(&read, file, "/run"), STATUS_OK);
  assert_int_equal(read.limit_count, 2);
  assert_true(read.limit_steps[0] == 3 && read.limit_steps[1] == 2);
  assert_string_equal(read.limit_names[1], "watchdog");
  assert_int_equal(read.back_count, 1);
  assert_string_equal(read.backs[0].cause, "density");
  assert_true(read.backs[0].back_to == 1 && read.backs[0].dt == 0.5);
  h5_close(file);
  step_log_free(&log);
  step_log_free(&read);
  assert_int_equal(memory_in_use(), 0);
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_worst), cmocka_unit_test(test_energy),
                                     cmocka_unit_test(test_three_halvings),
                                     cmocka_unit_test(test_log_round_trip)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
