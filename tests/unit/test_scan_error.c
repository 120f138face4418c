/* What the error of k owes to the scan. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <math.h>
#include <cmocka.h>

#include "sphsolve/error/scan_error.h"

#define VOXEL 5.83e-6

/* A change of ln k of .064 by the blur once more, and pores 10 blurs wide. */
static void test_error(void **state) {
  (void)state;
  struct scan_quality scan = {.blur = 11e-6,
                              .blur_error = 0.5e-6,
                              .resolution = 24e-6,
                              .noise_power = 1e-17,
                              .removed = true};
  assert_true(scan_error(&scan, 0.064, 110e-6) < 0.06);
  scan.removed = false;
  const double kept = scan_error(&scan, 0.064, 110e-6);
  assert_true(kept > 0.094 && kept < 0.2);
}

/* Slices four times as far apart as pixels: the triangle's variance counts beside the blur's, up to
 * three tenths of k. */
static void test_drawn(void **state) {
  (void)state;
  struct scan_quality scan = {.blur = 11e-6,
                              .blur_error = 0.5e-6,
                              .resolution = 29.278e-6, /* a deviation of 10 um */
                              .noise_power = 1e-17,
                              .removed = true};
  const double cubes = scan_error(&scan, 0.064, 110e-6);
  scan.between = 15.0 * VOXEL * VOXEL / 18.0;
  const double drawn = 1.5 * (15.0 * 5.83 * 5.83 / 18.0 / 100.0) * 0.064;
  assert_float_equal(scan_error(&scan, -0.064, 110e-6), hypot(cubes, drawn), 1e-5);
  scan.between *= 1e3;
  assert_float_equal(scan_error(&scan, 0.064, 110e-6), hypot(cubes, 0.3), 1e-9);
}

/* What is left of a blur known to 5 %: in wide pores of a scan without noise only its uncertainty;
 * more with noise, in mean over the volume of the blur, with smooth walls, and in pores five blurs
 * wide. */
#define WIDE 1.0 /* m */
static void test_noise(void **state) {
  (void)state;
  struct scan_quality scan = {
      .blur = 10e-6, .blur_error = 0.5e-6, .resolution = 24e-6, .removed = true};
  const double change = 0.1, grown = 1.3 * change, least = hypot(0.035, 0.2 * grown);
  assert_float_equal(scan_error(&scan, change, WIDE), least, 1e-9);
  scan.noise_power = 0.25 * 1e-15; /* half the contrast over that volume */
  assert_float_equal(scan_error(&scan, change, WIDE), hypot(least, 0.3 * grown), 1e-9);
  scan.noise_power = 0.0;
  scan.smooth_walls = 1.0;
  assert_float_equal(scan_error(&scan, change, WIDE), hypot(least, 0.3 * grown), 1e-9);
  scan.smooth_walls = 0.0;
  assert_float_equal(scan_error(&scan, change, 50e-6), hypot(least, 0.2 * grown), 1e-9);
}

/* Of noise more is counted where walls are smooth: nothing makes up for what it leaves of it. */
static void test_smooth(void **state) {
  (void)state;
  struct scan_quality scan = {.blur = 11e-6,
                              .blur_error = 0.5e-6,
                              .resolution = 24e-6,
                              .noise_power = 125e-18, /* 5 um */
                              .removed = true};
  const double relief = scan_error(&scan, 0.0, 100e-6);
  scan.smooth_walls = 1.0;
  assert_float_equal(relief, hypot(0.035, 0.4 * 0.05), 1e-9);
  assert_float_equal(scan_error(&scan, 0.0, 100e-6), hypot(0.035, 0.05), 1e-9);
}

/* Before anything is solved the change by another blur is expected to go with the square of the
 * blur's width over that of the pores. */
static void test_expected(void **state) {
  (void)state;
  struct scan_quality scan = {.resolution = 24e-6};
  const double change = scan_change_expected(&scan, 50e-6);
  assert_true(change > 0.0);
  assert_true(fabs(scan_change_expected(&scan, 100e-6) / change - 0.25) < 1e-9);
  scan.resolution *= 2.0;
  assert_true(fabs(scan_change_expected(&scan, 100e-6) / change - 1.0) < 1e-9);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_expected), cmocka_unit_test(test_error),
                                     cmocka_unit_test(test_drawn), cmocka_unit_test(test_noise),
                                     cmocka_unit_test(test_smooth)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
