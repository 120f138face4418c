/* Resampling against the formula, evaluated directly in three dimensions. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ct2model/resample/reduce.h"
#include "ct2model/resample/reduce.h"
#include "ct2model/resample/resample.h"

/* Keys (1981), eq. 4 with a = -3/4, written out. */
static double cubic(double s) {
  s = fabs(s);
  if (s <= 1.0) return 1.25 * s * s * s - 2.25 * s * s + 1.0;
  if (s < 2.0) return -0.75 * s * s * s + 3.75 * s * s - 6.0 * s + 3.0;
  return 0.0;
}

static double weight(enum filter filter, double k, double centre, double factor) {
  if (filter == FILTER_BICUBIC) return cubic((k + 0.5 - centre) / (factor > 1.0 ? factor : 1.0));
  double low = centre - factor / 2.0, high = centre + factor / 2.0;
  return fmax(0.0, fmin(k + 1.0, high) - fmax(k, low));
}

static double direct(enum filter filter, const float *in, const size_t n[3], const size_t m[3],
                     const size_t at[3]) {
  double sum = 0.0, norm = 0.0, f[3], c[3];
  for (int d = 0; d < 3; d++) {
    f[d] = (double)n[d] / (double)m[d];
    c[d] = ((double)at[d] + 0.5) * f[d];
  }
  for (size_t z = 0; z < n[2]; z++)
    for (size_t y = 0; y < n[1]; y++)
      for (size_t x = 0; x < n[0]; x++) {
        double w = weight(filter, (double)x, c[0], f[0]) * weight(filter, (double)y, c[1], f[1]) *
                   weight(filter, (double)z, c[2], f[2]);
        sum += w * (double)in[(z * n[1] + y) * n[0] + x];
        norm += w;
      }
  return sum / norm;
}

static float *resample(enum filter filter, const float *in, const size_t n[3], const size_t m[3],
                       size_t batch) {
  struct resampler resampler;
  float *out = calloc(m[0] * m[1] * m[2], sizeof *out);
  assert_int_equal(resampler_start(filter, n, m, batch, &resampler), STATUS_OK);
  for (size_t z = 0; z < n[2]; z += batch) {
    const size_t count = n[2] - z < batch ? n[2] - z : batch;
    for (size_t i = 0; i < count; i++) {
      const struct pixel_rows slice = {in + (z + i) * n[0] * n[1], n[0] * sizeof *in, PIXEL_F32,
                                       1.0f};
      if (!resampler_wants(&resampler, z + i)) continue;
      if (!resampler_takes_rows(&resampler)) {
        assert_int_equal(resampler_point(&resampler, &slice, i), STATUS_OK);
        continue;
      }
      struct reduction reduction;
      resampler_begin(&resampler, i, &reduction);
      for (size_t y = 0; y < n[1]; y++)
        reduction_add(&reduction, pixel_rows_at(&slice, y, n[0], NULL));
    }
    resampler_add(&resampler, z, count, out);
  }
  resampler_end(&resampler);
  return out;
}

static float *noise(const size_t n[3]) {
  float *in = malloc(n[0] * n[1] * n[2] * sizeof *in);
  srand(3);
  for (size_t i = 0; i < n[0] * n[1] * n[2]; i++) in[i] = (float)(rand() % 1000);
  return in;
}

static void compare(enum filter filter, const size_t n[3], const size_t m[3]) {
  float *in = noise(n), *out = resample(filter, in, n, m, 5);
  for (size_t z = 0; z < m[2]; z++)
    for (size_t y = 0; y < m[1]; y++)
      for (size_t x = 0; x < m[0]; x++) {
        const size_t at[3] = {x, y, z};
        double expected = direct(filter, in, n, m, at);
        assert_true(fabs((double)out[(z * m[1] + y) * m[0] + x] - expected) < 1e-2);
      }
  free(in);
  free(out);
}

static void test_bicubic_is_the_formula(void **state) {
  (void)state;
  compare(FILTER_BICUBIC, (size_t[3]){24, 16, 24}, (size_t[3]){3, 4, 3});
  compare(FILTER_BICUBIC, (size_t[3]){19, 23, 17}, (size_t[3]){7, 5, 6}); /* no whole factor */
  compare(FILTER_BICUBIC, (size_t[3]){6, 5, 4}, (size_t[3]){9, 10, 7});   /* enlarged */
}

static void test_area_is_the_formula(void **state) {
  (void)state;
  compare(FILTER_AREA, (size_t[3]){24, 16, 24}, (size_t[3]){3, 4, 3});
  compare(FILTER_AREA, (size_t[3]){19, 23, 17}, (size_t[3]){7, 5, 6});
}

static void test_constants_stay(void **state) {
  (void)state;
  const size_t n[3] = {30, 20, 10}, m[3] = {7, 6, 5};
  float *in = malloc(30 * 20 * 10 * sizeof *in);
  for (size_t i = 0; i < 30 * 20 * 10; i++) in[i] = 41.5f;
  for (int filter = FILTER_BICUBIC; filter <= FILTER_AREA; filter++) {
    float *out = resample((enum filter)filter, in, n, m, 3);
    for (size_t i = 0; i < 7 * 6 * 5; i++) assert_true(fabs((double)out[i] - 41.5) < 1e-4);
    free(out);
  }
  free(in);
}

/* A wave too fine for the new grid must vanish; without antialiasing it becomes another wave. */
static void test_bicubic_antialiases(void **state) {
  (void)state;
  const size_t n[3] = {64, 64, 64}, m[3] = {8, 8, 8};
  float *in = malloc(64 * 64 * 64 * sizeof *in);
  for (int axis = 0; axis < 3; axis++) {
    for (size_t i = 0; i < 64 * 64 * 64; i++) {
      const size_t at[3] = {i % 64, i / 64 % 64, i / 4096};
      in[i] = (float)cos(2.0 * M_PI * 7.0 * (double)at[axis] / 48.0);
    }
    float *fine = resample(FILTER_BICUBIC, in, n, m, 16);
    float *point = resample(FILTER_BICUBIC_POINT, in, n, m, 16);
    double left = 0.0, aliased = 0.0;
    for (size_t z = 2; z < 6; z++)
      for (size_t y = 2; y < 6; y++)
        for (size_t x = 2; x < 6; x++) {
          left = fmax(left, fabs((double)fine[(z * 8 + y) * 8 + x]));
          aliased = fmax(aliased, fabs((double)point[(z * 8 + y) * 8 + x]));
        }
    assert_true(left < 0.15);
    assert_true(aliased > 0.5);
    free(fine);
    free(point);
  }
  free(in);
}

static void test_point_takes_single_slices(void **state) {
  (void)state;
  const size_t n[3] = {4, 4, 16}, m[3] = {4, 4, 2};
  float in[4 * 4 * 16];
  for (size_t i = 0; i < 256; i++) in[i] = (float)(i / 16);
  float *out = resample(FILTER_BICUBIC_POINT, in, n, m, 5);
  for (size_t i = 0; i < 16; i++) {
    assert_true(out[i] == 4.0f);
    assert_true(out[16 + i] == 12.0f);
  }
  free(out);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_bicubic_is_the_formula),
      cmocka_unit_test(test_area_is_the_formula),
      cmocka_unit_test(test_constants_stay),
      cmocka_unit_test(test_bicubic_antialiases),
      cmocka_unit_test(test_point_takes_single_slices),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
