/* Volumes within flat walls, to hundredths of a voxel. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "ct2model/scan/enclosed.h"
#include "ct2model/scan/labels.h"

enum { NX = 20, NY = 12, NZ = 20, COUNT = NX * NY * NZ };
static float greys[COUNT];
static uint8_t grain[COUNT];
static const bool plain[3];
static const struct enclosed_sides periodic;

static struct region held(const void *values, enum pixel_type type) {
  static const struct stack stack = {.size = {NX, NY, NZ}};
  return (struct region){.stack = &stack,
                         .size = {NX, NY, NZ},
                         .voxel = {1.0, 1.0, 1.0},
                         .scale = 1.0,
                         .held = values,
                         .held_type = type};
}

/* A slit across x whose two planes of partly filled voxels have greys of their own: where they
 * stand as planes of equal grey no count of voxels lies between 5 / 20 and 7 / 20. */
static void test_a_slit_between_voxels(void **state) {
  (void)state;
  struct grey_histogram volume = {0};
  const float row[NX] = {1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 0.6f, 0.0f, 0.0f, 0.0f,
                         0.0f, 0.0f, 0.2f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f, 1.0f};
  for (size_t i = 0; i < COUNT; i++) greys[i] = row[i % NX];
  const struct region region = held(greys, PIXEL_F32);
  assert_int_equal(enclosed_measure(&region, &periodic, 0.1, 0.9, &volume), STATUS_OK);
  for (double grey = 0.25; grey < 0.6; grey += 0.05) {
    const double from = 6.5 + (0.6 - grey) / 0.6, to = 12.5 + (grey - 0.2) / 0.8;
    const double share = (to - from) / NX;
    assert_true(fabs(grey_histogram_porosity(&volume, grey) - share) < 2e-4);
    assert_true(fabs(grey_histogram_quantile(&volume, share) - grey) < 2e-3);
  }
  grey_histogram_end(&volume);
}

/* Mirrored about the first face and the last centre n voxels become 2 n - 1; with faces they stay
 * n.
 */
static void test_what_is_mirrored_counts_twice(void **state) {
  (void)state;
  for (size_t i = 0; i < COUNT; i++) greys[i] = i / (NX * NY) < 5 ? 0.0f : 1.0f;
  const struct region region = held(greys, PIXEL_F32);
  for (int faces = 0; faces < 2; faces++) {
    struct grey_histogram volume = {0};
    const struct enclosed_sides sides = {.reflect = {true, false, true}, .faces = faces != 0};
    const double share = faces ? 5.0 / NZ : 10.0 / (2 * NZ - 1);
    assert_int_equal(enclosed_measure(&region, &sides, 0.0, 1.0, &volume), STATUS_OK);
    assert_true(fabs(grey_histogram_porosity(&volume, 0.5) - share) < 1e-3);
    grey_histogram_end(&volume);
  }
}

/* Labels of a slit at p : q to the axes; its walls are those of its complement, turned round, so
 * that halfway between pore and grain they enclose the labels' volume. */
static void check_turned(size_t p, size_t q, double grey) {
  struct region region = held(NULL, PIXEL_U8);
  struct labels labels = {.on = true};
  for (size_t i = 0; i < COUNT; i++) grain[i] = (p * (i % NX) + q * (i / (NX * NY))) % NX >= NX / 2;
  labels.porosity = 0.5;
  assert_int_equal(labels_smooth(&region, grain, plain, &labels), STATUS_OK);
  assert_true(fabs(labels.threshold - 0.5 * LABEL_GREY) < grey);
  labels_end(&labels);
}

static void test_labels_at_45_degrees(void **state) {
  (void)state;
  check_turned(1, 0, 0.5);
  check_turned(1, 1, 0.5);
  check_turned(2, 1, 0.5);
  check_turned(3, 1, 0.5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_a_slit_between_voxels),
      cmocka_unit_test(test_what_is_mirrored_counts_twice),
      cmocka_unit_test(test_labels_at_45_degrees),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
