/* Steady detection on series whose end is known: it never stops early. */
#include "sphsolve/march/monitor.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

static double noise(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0 - 0.5;
}

/* Feeds f(i) until steady; returns the samples taken (limit: never) and the verdict. */
static size_t feed(double (*f)(size_t i, uint64_t *seed), uint64_t seed, double tolerance,
                   size_t limit, struct monitor_verdict *verdict) {
  struct monitor monitor = {0};
  size_t n = 0;
  for (; n < limit; n++) {
    double value[MONITOR_COMPONENTS] = {f(n, &seed)};
    assert_int_equal(monitor_add(&monitor, value), STATUS_OK);
    *verdict = monitor_judge(&monitor, tolerance, 80);
    if (verdict->steady) break;
  }
  monitor_free(&monitor);
  return n;
}

static double fast(size_t i, uint64_t *seed) {
  (void)seed;
  return 3 * (1 - exp(-(double)i / 15));
}
static double slow(size_t i, uint64_t *seed) {
  (void)seed;
  return 1 - 0.3 * exp(-(double)i / 20) - 0.1 * exp(-(double)i / 600);
}
static double noisy(size_t i, uint64_t *seed) {
  return (1 - exp(-(double)i / 30)) * (1 + 0.004 * noise(seed));
}
static double ramp(size_t i, uint64_t *seed) {
  return 1 + 1e-3 * (double)i + 0.002 * noise(seed);
}
static double wave(size_t i, uint64_t *seed) {
  (void)seed;
  return 1 + 0.2 * sin((double)i / 40);
}

static void test_truth_within_error(void **state) {
  (void)state;
  const struct {
    double (*f)(size_t, uint64_t *);
    double truth;
  } cases[] = {{fast, 3}, {slow, 1}, {noisy, 1}};
  for (size_t c = 0; c < 3; c++)
    for (uint64_t seed = 1; seed < 20; seed++) {
      struct monitor_verdict verdict;
      size_t n = feed(cases[c].f, seed, 1e-4, 20000, &verdict);
      assert_true(n < 20000);
      assert_true(fabs(verdict.mean[0] / cases[c].truth - 1) <= verdict.error);
    }
}

/* What flows of moving particles look like: an approach, and about it a wander that remembers
 * itself for `memory` samples. */
static double remembered, memory;
static double flow(size_t i, uint64_t *seed) {
  double keep = exp(-1 / memory);
  if (i == 0) remembered = 0;
  remembered = keep * remembered + 0.01 * sqrt(1 - keep * keep) * sqrt(12) * noise(seed);
  return (1 - exp(-(double)i / 12)) * (1 + remembered) - 0.05 * exp(-(double)i / 60);
}

/* The mean at the stop lies within its own error of that of a run ten times as long. The error is a
 * 95 % one: one in twenty may miss. */
static void test_ten_times_as_long(void **state) {
  (void)state;
  const double memories[] = {1, 4, 10, 25}, tolerances[] = {5e-3, 1e-4};
  int runs = 0, missed = 0;
  for (int m = 0; m < 4; m++)
    for (int t = 0; t < 2; t++)
      for (uint64_t seed = 1; seed <= 100; seed++) {
        struct monitor monitor = {0};
        struct monitor_verdict stop = {0};
        uint64_t noise_state = seed;
        size_t last = 40000;
        memory = memories[m];
        for (size_t n = 0; n < last; n++) {
          double value[MONITOR_COMPONENTS] = {flow(n, &noise_state)};
          assert_int_equal(monitor_add(&monitor, value), STATUS_OK);
          if (stop.steady) continue;
          stop = monitor_judge(&monitor, tolerances[t], 80);
          if (stop.steady) last = 10 * (n + 1);
        }
        assert_true(stop.steady);
        double later = monitor_judge(&monitor, tolerances[t], 80).mean[0];
        missed += fabs(stop.mean[0] / later - 1) > stop.error;
        runs++;
        monitor_free(&monitor);
      }
  print_message("%d of %d outside their error\n", missed, runs);
  assert_true(20 * missed <= runs);
}

static void test_never_steady(void **state) {
  (void)state;
  struct monitor_verdict verdict;
  assert_int_equal(feed(ramp, 3, 1e-4, 3000, &verdict), 3000);
  assert_int_equal(feed(wave, 3, 1e-4, 3000, &verdict), 3000);
  assert_int_equal(feed(fast, 3, 1e-4, 79, &verdict), 79);
}

/* A velocity that has not changed since t = 1 has settled when that is a tenth of the time. */
static void test_settled(void **state) {
  (void)state;
  struct monitor_settling settling = {0};
  double found = 0;
  for (int i = 0; i <= 200 && found == 0; i++) {
    const double t = 0.01 * i, velocity[3] = {fmin(t, 1), 0, -fmin(t, 1)};
    if (monitor_settled(&settling, 1e-3, t, velocity)) found = t;
  }
  assert_true(fabs(found - 1 / 0.9) < 0.02);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_truth_within_error),
      cmocka_unit_test(test_ten_times_as_long),
      cmocka_unit_test(test_never_steady),
      cmocka_unit_test(test_settled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
