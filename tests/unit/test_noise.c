/* Noise of a scan that is saved from black on: what was cut off is known from how much is black. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/memory.h"
#include "ct2model/scanner/noise.h"
#include "ct2model/scanner/windows.h"

enum { SIDE = 64, N = SIDE * SIDE * SIDE };
static const double DEVIATION = 0.25;

/* Nearly normal: the sum of twelve uniform numbers (SplitMix64). */
static void draw(double black, float *grey) {
  for (uint64_t i = 0; i < N; i++) {
    double sum = -6.0;
    for (uint64_t k = 0; k < 12; k++) {
      uint64_t z = (12 * i + k + 1) * 0x9e3779b97f4a7c15U;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
      sum += (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    grey[i] = (float)fmax(DEVIATION * sum, black);
  }
}

static void test_cut_off(void **state) {
  (void)state;
  static const double CUT[] = {0.0, 0.8, 1.15, 1.6, 2.3, INFINITY}; /* deviations under the mean */
  float *grey = NULL, *deep = NULL;
  assert_int_equal(memory_allocate(&grey, N, sizeof *grey, "test"), 0);
  assert_int_equal(memory_allocate(&deep, N, sizeof *deep, "test"), 0);
  for (size_t i = 0; i < N; i++) deep[i] = 10.0F;
  for (size_t c = 0; c < sizeof CUT / sizeof *CUT; c++) {
    struct windows all = {.count = 1, .window = {{.size = {SIDE, SIDE, SIDE}, .grey = grey}}};
    double ends[2];
    draw(-CUT[c] * DEVIATION, grey);
    windows_find_ends(&all, ends);
    struct noise_sums sums = {.end = ends[0]};
    noise_add(grey, deep, all.window[0].size, 1.5, 1.0, 0.0, INFINITY, &sums);
    const double seen = noise_deviation(&sums), found = seen / noise_left(&sums);
    print_message("cut %g deviations under the mean: %.4f seen, %.4f found\n", CUT[c], seen, found);
    const bool cut = isfinite(CUT[c]), black = isfinite(ends[0]), white = isfinite(ends[1]);
    assert_true(black == cut && !white);
    if (c == 2) assert_true(seen < 0.9 * DEVIATION);
    /* Half and more of one grey is a drawn image: nothing is added. */
    if (c == 0) assert_true(found == seen);
    if (c > 0) assert_true(fabs(found / DEVIATION - 1.0) < 0.01);
  }
  memory_free(&grey);
  memory_free(&deep);
}

/* Few grey levels, as of little noise, are not cut off. */
static void test_levels(void **state) {
  (void)state;
  float *grey = NULL;
  double ends[2];
  assert_int_equal(memory_allocate(&grey, N, sizeof *grey, "test"), 0);
  struct windows all = {.count = 1, .window = {{.size = {SIDE, SIDE, SIDE}, .grey = grey}}};
  draw(-INFINITY, grey);
  for (size_t i = 0; i < N; i++) grey[i] = roundf(3.0F * grey[i]);
  windows_find_ends(&all, ends);
  const bool black = isfinite(ends[0]), white = isfinite(ends[1]);
  assert_true(!black && !white);
  memory_free(&grey);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_cut_off), cmocka_unit_test(test_levels)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
