/* What narrow throats require: sizes of pores and grains by stereology, and when the grey of pore
 * is corrected and grain and pore are told to be two phases. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "ct2model/scanner/restored.h"

enum { SIDE = 48, EDGE = 24 };
#define RADIUS 9.0
#define VOXEL 2e-6

/* Balls of one size, cubic: 6 V / S is their diameter. */
static void test_measure(void **state) {
  (void)state;
  static uint8_t levels[SIDE * SIDE * SIDE];
  const struct region region = {.size = {SIDE, SIDE, SIDE}, .voxel = {VOXEL, VOXEL, VOXEL}};
  const struct restore restore = {
      .region = &region,
      .count = {1, 1, 1},
      .levels = {.step = 1, .size = {SIDE, SIDE, SIDE}, .levels = levels}};
  for (size_t i = 0; i < sizeof levels; i++) {
    const double x = remainder((double)(i % SIDE) - 11.8, EDGE);
    const double y = remainder((double)(i / SIDE % SIDE) - 12.1, EDGE);
    const double z = remainder((double)(i / SIDE / SIDE) - 11.9, EDGE);
    levels[i] = hypot(x, hypot(y, z)) < RADIUS ? 255 : 0;
  }
  const struct narrow_throats found = narrow_throats_measure(&restore, 127.5);
  const double surface = 4.0 * M_PI * RADIUS * RADIUS, cell = EDGE * EDGE * EDGE;
  const double pore = 4.0 * (cell - surface * RADIUS / 3.0) / surface * VOXEL;
  print_message("grains %g of %g m, pores %g of %g m\n", found.grain_diameter, 2.0 * RADIUS * VOXEL,
                found.pore_width, pore);
  assert_true(fabs(found.grain_diameter / (2.0 * RADIUS * VOXEL) - 1.0) < 0.03);
  assert_true(fabs(found.pore_width / pore - 1.0) < 0.03);
}

static void test_nothing(void **state) {
  (void)state;
  uint8_t levels[8] = {0};
  const struct region region = {.size = {2, 2, 2}, .voxel = {VOXEL, VOXEL, VOXEL}};
  const struct restore restore = {.region = &region,
                                  .count = {1, 1, 1},
                                  .levels = {.step = 1, .size = {2, 2, 2}, .levels = levels}};
  const struct scanner scanner = {.blur = 3.0 * VOXEL, .contrast_to_noise = 20.0};
  const struct narrow_throats none = narrow_throats_measure(&restore, 127.5);
  assert_true(isnan(none.pore_width) && isnan(none.grain_diameter));
  assert_true(narrow_throats_pore_excess(&none, &scanner, 100.0) == 0.0);
  assert_true(narrow_throats_two_phases(&none, &scanner) == 0.0);
}

static void test_pore_excess(void **state) {
  (void)state;
  const struct scanner sand = {.blur = 2.0, .contrast_to_noise = 10.0};
  const struct scanner smooth = {.blur = 2.0, .contrast_to_noise = 10.0, .smooth_walls = 1.0};
  const struct narrow_throats narrow = {.pore_width = 9.0}, wide = {.pore_width = 13.0};
  assert_true(fabs(narrow_throats_pore_excess(&narrow, &sand, 99.0) - 0.1) < 1e-12);
  assert_true(narrow_throats_pore_excess(&narrow, &sand, 120.0) == 0.0);
  assert_true(narrow_throats_pore_excess(&narrow, &sand, 140.0) == 0.0);
  assert_true(narrow_throats_pore_excess(&narrow, &sand, 70.0) == 0.0); /* not the grey alone */
  assert_true(narrow_throats_pore_excess(&wide, &sand, 99.0) == 0.0);
  assert_true(narrow_throats_pore_excess(&narrow, &smooth, 99.0) == 0.0);
}

static void test_two_phases(void **state) {
  (void)state;
  const struct scanner sand = {.blur = 2.0, .contrast_to_noise = 10.0};
  const struct scanner noisy = {.blur = 2.0, .contrast_to_noise = 6.0};
  const struct scanner smooth = {.blur = 2.0, .contrast_to_noise = 10.0, .smooth_walls = 1.0};
  const struct scanner assumed = {.blur = 2.0, .contrast_to_noise = 10.0, .assumed = true};
  const struct narrow_throats narrow = {.grain_diameter = 16.0}, between = {.grain_diameter = 18.0},
                              wide = {.grain_diameter = 20.0};
  assert_true(narrow_throats_two_phases(&narrow, &sand) == 1.0);
  assert_true(fabs(narrow_throats_two_phases(&between, &sand) - 0.5) < 1e-12);
  assert_true(narrow_throats_two_phases(&wide, &sand) == 0.0);
  assert_true(narrow_throats_two_phases(&narrow, &noisy) == 0.0);
  assert_true(narrow_throats_two_phases(&narrow, &smooth) == 0.0);
  assert_true(narrow_throats_two_phases(&narrow, &assumed) == 0.0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_measure), cmocka_unit_test(test_nothing),
                                     cmocka_unit_test(test_pore_excess),
                                     cmocka_unit_test(test_two_phases)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
