/* Thresholds against what they are defined by. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "ct2model/calibrate/calibrate.h"

static void test_threshold_counts_what_is_mirrored(void **state) {
  (void)state;
  enum { NX = 20, NY = 25, NZ = 3 };
  static float volume[NX * NY * NZ];
  srand(11);
  for (size_t i = 0; i < NX * NY * NZ; i++) volume[i] = (float)rand() / 1e6f - 500.0f;
  for (int axes = 0; axes < 8; axes++) {
    const struct mirroring mirroring = {{NX, NY, NZ},
                                        {(axes & 1) != 0, (axes & 2) != 0, (axes & 4) != 0}};
    double sites = 1.0;
    for (int d = 0; d < 3; d++)
      sites *= (double)(mirroring.mirrored[d] ? 2 * mirroring.size[d] - 1 : mirroring.size[d]);
    for (double porosity = 0.05; porosity < 1.0; porosity += 0.05) {
      double threshold;
      assert_int_equal(volume_threshold(volume, &mirroring, porosity, &threshold), STATUS_OK);
      size_t pores = 0;
      for (size_t i = 0; i < NX * NY * NZ; i++) {
        const size_t at[3] = {i % NX, i / NX % NY, i / NX / NY};
        size_t often = 1;
        for (int d = 0; d < 3; d++)
          often *= mirroring.mirrored[d] && at[d] + 1 < mirroring.size[d] ? 2u : 1u;
        if (!((double)volume[i] > threshold)) pores += often;
      }
      assert_true(fabs((double)pores - porosity * sites) <= 4.0); /* half of what one is, 8 */
    }
  }
}

static void test_tied_greys_go_to_the_nearer_count(void **state) {
  (void)state;
  float volume[10] = {1, 1, 5, 5, 5, 5, 5, 9, 9, 9};
  const struct mirroring plain = {.size = {10, 1, 1}};
  double threshold;
  (void)volume_threshold(volume, &plain, 0.4, &threshold); /* 2 of 5 fives: they stay solid */
  assert_true(threshold < 5.0 && threshold > 1.0);
  (void)volume_threshold(volume, &plain, 0.5, &threshold); /* 3 of 5: they become pore */
  assert_true(threshold >= 5.0 && threshold < 9.0);
}

static void test_negative_greys_are_ordered(void **state) {
  (void)state;
  float volume[6] = {-3, -1, -2, 0, 2, 1};
  const struct mirroring plain = {.size = {1, 6, 1}};
  double threshold;
  (void)volume_threshold(volume, &plain, 0.5, &threshold);
  assert_true(threshold >= -1.0 && threshold < 0.0);
}

static void test_quantile_and_porosity_are_inverse(void **state) {
  (void)state;
  struct grey_histogram histogram;
  assert_int_equal(grey_histogram_start(-0.5, 1.0, 256, &histogram), STATUS_OK);
  float values[1000];
  srand(5);
  for (size_t i = 0; i < 1000; i++) values[i] = (float)(20 + rand() % 180);
  grey_histogram_add(&histogram, values, 1000);
  for (double n = 0.03; n < 1.0; n += 0.07)
    assert_true(fabs(grey_histogram_porosity(&histogram, grey_histogram_quantile(&histogram, n)) -
                     n) < 1e-12);
  /* Half-way between levels nothing is interpolated. */
  size_t below = 0;
  for (size_t i = 0; i < 1000; i++) below += values[i] <= 77.0f;
  assert_true(fabs(grey_histogram_porosity(&histogram, 77.5) - (double)below / 1000.0) < 1e-12);
  grey_histogram_end(&histogram);
}

/* Two normal phases: 40 +- 5 (30 %) and 120 +- 8 (70 %). */
static void add_normal(struct grey_histogram *histogram, double mean, double sd, double count) {
  for (size_t i = 0; i < histogram->bins; i++) {
    double grey = histogram->low + histogram->width * ((double)i + 0.5), u = (grey - mean) / sd;
    uint64_t n = (uint64_t)(count * exp(-0.5 * u * u) / (sd * sqrt(2.0 * M_PI)) + 0.5);
    histogram->counts[i] += n;
    histogram->total += n;
  }
}

static void test_phases_and_otsu(void **state) {
  (void)state;
  struct grey_histogram histogram;
  struct grey_phases phases;
  (void)grey_histogram_start(-0.5, 1.0, 256, &histogram);
  add_normal(&histogram, 40, 5, 3e5);
  add_normal(&histogram, 120, 8, 7e5);
  double otsu = grey_histogram_otsu(&histogram);
  assert_true(otsu > 70.0 && otsu < 95.0);
  for (double threshold = 60; threshold < 110; threshold += 10) {
    grey_histogram_phases(&histogram, threshold, &phases);
    assert_true(fabs(phases.pore_peak - 40.0) < 1.0 && fabs(phases.grain_peak - 120.0) < 1.0);
    assert_true(phases.valley > 55.0 && phases.valley < 95.0 && phases.valley_depth < 0.01);
    assert_true(fabs(phases.noise - 5.0) < 0.8);
  }
  grey_histogram_end(&histogram);
}

/* A histogram that is its own mirror image has mirrored peaks, half-way between which it lies. */
static void test_peaks_have_no_bias(void **state) {
  (void)state;
  struct grey_histogram histogram;
  struct grey_phases phases;
  (void)grey_histogram_start(0.0, 1.0, 200, &histogram);
  add_normal(&histogram, 60.5, 8, 5e5);
  add_normal(&histogram, 139.5, 8, 5e5);
  grey_histogram_phases(&histogram, 100, &phases);
  print_message("peaks %g, %g, valley %g\n", phases.pore_peak, phases.grain_peak, phases.valley);
  assert_true(fabs(phases.pore_peak + phases.grain_peak - 200.0) < 0.1);
  grey_histogram_end(&histogram);
}

static void test_one_broad_peak_has_no_valley(void **state) {
  (void)state;
  struct grey_histogram histogram;
  struct grey_phases phases;
  (void)grey_histogram_start(-0.5, 1.0, 256, &histogram);
  add_normal(&histogram, 100, 20, 1e6);
  grey_histogram_phases(&histogram, 90, &phases);
  assert_true(phases.valley_depth > 0.9);
  grey_histogram_end(&histogram);
}

/* dT/de of a uniform histogram: n = T / 256, e = n / (1 - n), so dT/de = 256 (1 - n)^2. */
static void test_slope(void **state) {
  (void)state;
  struct grey_histogram histogram;
  (void)grey_histogram_start(-0.5, 1.0, 256, &histogram);
  for (size_t i = 0; i < 256; i++) histogram.counts[i] = 1000;
  histogram.total = 256000;
  assert_true(fabs(grey_histogram_slope(&histogram, 0.4) / (256.0 * 0.36) - 1.0) < 1e-3);
  grey_histogram_end(&histogram);
  /* The same levels as floats: one bin of many. */
  (void)grey_histogram_start(0.0, 1.0 / 64.0, 64 * 256, &histogram);
  for (size_t i = 0; i < 256; i++) histogram.counts[64 * i + 20] = 1000;
  histogram.total = 256000;
  assert_true(fabs(grey_histogram_slope(&histogram, 0.4) / (256.0 * 0.36) - 1.0) < 1e-3);
  grey_histogram_end(&histogram);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_threshold_counts_what_is_mirrored),
      cmocka_unit_test(test_tied_greys_go_to_the_nearer_count),
      cmocka_unit_test(test_negative_greys_are_ordered),
      cmocka_unit_test(test_quantile_and_porosity_are_inverse),
      cmocka_unit_test(test_phases_and_otsu),
      cmocka_unit_test(test_peaks_have_no_bias),
      cmocka_unit_test(test_one_broad_peak_has_no_valley),
      cmocka_unit_test(test_slope),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
