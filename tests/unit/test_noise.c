/* Noise of a scan that is saved from black on: what was cut off is known from how much is black. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/memory.h"
#include "ct2model/scanner/gaussian.h"
#include "ct2model/scanner/noise.h"
#include "ct2model/scanner/windows.h"

enum { SIDE = 64, N = SIDE * SIDE * SIDE };
static const double DEVIATION = 0.25;

/* Nearly normal: the sum of twelve uniform numbers (SplitMix64), from the `first` on. */
static void draw_from(uint64_t first, double black, float *grey) {
  for (uint64_t v = 0; v < N; v++) {
    const uint64_t i = first + v;
    double sum = -6.0;
    for (uint64_t k = 0; k < 12; k++) {
      uint64_t z = (12 * i + k + 1) * 0x9e3779b97f4a7c15U;
      z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
      z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
      sum += (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }
    grey[v] = (float)fmax(DEVIATION * sum, black);
  }
}
static void draw(double black, float *grey) {
  draw_from(0, black, grey);
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
    windows_find_clipping(&all, ends);
    struct noise_sums sums = {.end = ends[0]};
    noise_add(grey, deep, all.window[0].size, 1.5, 1.0, 0.0, INFINITY, &sums);
    const double seen = noise_deviation(&sums), found = seen / noise_clipping_ratio(&sums);
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
  windows_find_clipping(&all, ends);
  const bool black = isfinite(ends[0]), white = isfinite(ends[1]);
  assert_true(!black && !white);
  memory_free(&grey);
}

/* Of a few voxels: the variance of a sample, about its own mean; in a slice of 32, half of them 1
 * above it and half 1 below, 32 / 31. */
static void test_few_voxels(void **state) {
  (void)state;
  static const size_t size[3] = {8, 4, 1};
  float grey[32], deep[32];
  struct noise_sums sums = {0};
  for (size_t i = 0; i < 32; i++) grey[i] = i < 16 ? 4.0F : 6.0F, deep[i] = 10.0F;
  noise_add(grey, deep, size, 1.5, 1.0, 0.0, INFINITY, &sums);
  assert_true(fabs(noise_deviation(&sums) - sqrt(32.0 / 31.0)) < 1e-12);
}

/* The deviation of noise alike over a length scatters from draw to draw as is said of one. */
static void test_chance(void **state) {
  (void)state;
  enum { DRAWS = 24 };
  static const double LENGTH[] = {0.5, 1.0};
  const size_t size[3] = {SIDE, SIDE, SIDE};
  float *grey = NULL, *work = NULL;
  assert_int_equal(memory_allocate(&grey, N, sizeof *grey, "test"), 0);
  assert_int_equal(memory_allocate(&work, N, sizeof *work, "test"), 0);
  for (size_t l = 0; l < 2; l++) {
    const double sigma[3] = {LENGTH[l], LENGTH[l], LENGTH[l]};
    double sum = 0.0, square = 0.0, said = 0.0;
    for (size_t d = 0; d < DRAWS; d++) {
      draw_from((l * DRAWS + d) * N, -INFINITY, grey);
      gaussian_filter(grey, size, sigma, work, grey);
      for (size_t i = 0; i < N; i++) work[i] = 10.0F;
      struct noise_sums sums = {0};
      noise_add(grey, work, size, 1.5, 1.0, 0.0, INFINITY, &sums);
      const double seen = noise_deviation(&sums);
      sum += seen / DRAWS;
      square += seen * seen / DRAWS;
      said += noise_deviation_error(&sums, LENGTH[l]) / DRAWS;
    }
    const double scatter = sqrt((square / (sum * sum) - 1.0) * DRAWS / (DRAWS - 1.0));
    print_message("noise alike over %g voxels: scatter %.4f, said %.4f\n", LENGTH[l], scatter,
                  said);
    assert_true(fabs(scatter / said - 1.0) < 0.4);
  }
  memory_free(&grey);
  memory_free(&work);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_cut_off), cmocka_unit_test(test_levels),
                                     cmocka_unit_test(test_few_voxels),
                                     cmocka_unit_test(test_chance)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
