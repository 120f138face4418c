/* Pore widths, correlation and windows of models whose answer is known. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>

#include "ct2model/model/morphology.h"

enum { N = 32, SITES = N * N * N };
static uint8_t solid[SITES];
static float distance[SITES];

static struct voxel_model make_model(void) {
  return (struct voxel_model){.size = {N, N, N},
                              .spacing = {2.0, 2.0, 2.0},
                              .periodic = {true, true, true},
                              .mirror_plane = -1,
                              .solid = solid,
                              .wall_distance = distance};
}

/* Slits of eight voxels between walls of eight: width 8, covariance a triangle wave along x. */
static void make_slits(void) {
  for (size_t i = 0; i < SITES; i++) {
    size_t x = i % 16;
    solid[i] = x >= 8;
    double in =
        x < 8 ? fmin((double)x + 0.5, 7.5 - (double)x) : -fmin((double)x - 7.5, 15.5 - (double)x);
    distance[i] = (float)(2.0 * in);
  }
}

static void test_slits(void **state) {
  (void)state;
  struct morphology m;
  make_slits();
  struct voxel_model model = make_model();
  assert_int_equal(morphology_measure(&model, N, &m), STATUS_OK);
  assert_true(fabs(m.touching - 0.25) < 1e-12);
  assert_true(fabs(m.thickness_median - 8.0) < 1.0);
  assert_true(m.expected_error > 0.004 && m.expected_error < 0.012);
  double sum = 0.0;
  for (int b = 0; b < THICKNESS_BINS; b++) sum += m.thickness_histogram[b];
  assert_true(fabs(sum - 1.0) < 1e-12);
}

/* A wall of three layers across the slits, with a gap of `gap` voxels: it rules, though hardly any
 * pore is as narrow. */
static void make_gap(double gap) {
  make_slits();
  for (size_t i = 10 * N * N; i < 13 * N * N; i++) {
    const double in = 0.5 * gap - fabs((double)(i % 16) + 0.5 - 4.5);
    solid[i] = in <= 0.0;
    distance[i] = (float)(2.0 * in);
  }
}

static void test_narrowest_place(void **state) {
  (void)state;
  struct morphology m;
  struct voxel_model model = make_model();
  make_gap(3.0);
  assert_int_equal(morphology_measure(&model, N, &m), STATUS_OK);
  assert_true(m.thickness_median > 7.0);
  assert_true(m.critical_width == 3.0); /* to an eighth of a voxel */
  assert_true(fabs(m.expected_error - 0.5 / 9.0) < 0.006);
  make_gap(2.875);
  assert_int_equal(morphology_measure(&model, N, &m), STATUS_OK);
  assert_true(m.critical_width == 2.875);
  make_gap(0.0);
  assert_int_equal(morphology_measure(&model, N, &m), STATUS_OK);
  assert_true(m.critical_width == 0.0 && isnan(m.expected_error));
}

static void test_windows_of_a_periodic_pattern(void **state) {
  (void)state;
  struct morphology m;
  make_slits();
  struct voxel_model model = make_model();
  assert_int_equal(morphology_measure(&model, N, &m), STATUS_OK);
  assert_int_equal(m.window_count, 4);          /* 4, 8, 16, 32 */
  for (size_t i = 2; i < m.window_count; i++) { /* whole periods: no spread */
    assert_true(fabs(m.window_mean[i] - 1.0) < 1e-12);
    assert_true(m.window_deviation[i] < 1e-6);
  }
  assert_true(m.window_deviation[0] > 0.5);
}

/* White noise is correlated with nothing but itself: half a voxel to each side. */
static void test_correlation_of_noise(void **state) {
  (void)state;
  struct morphology m;
  uint32_t seed = 1;
  for (size_t i = 0; i < SITES; i++) {
    seed = seed * 1664525u + 1013904223u;
    solid[i] = (uint8_t)(seed >> 31);
    distance[i] = solid[i] != 0 ? -0.1f : 0.1f;
  }
  struct voxel_model model = make_model();
  assert_int_equal(morphology_measure(&model, N, &m), STATUS_OK);
  assert_true(fabs(m.correlation_length / 2.0 - 0.5) < 0.06);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_slits),
      cmocka_unit_test(test_narrowest_place),
      cmocka_unit_test(test_windows_of_a_periodic_pattern),
      cmocka_unit_test(test_correlation_of_noise),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
