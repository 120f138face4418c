/* Slices denoised from many threads at once are those of one. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <string.h>

#include "ct2model/scan/denoise.h"

enum { SIDE = 16, PIXELS = SIDE * SIDE, SLICES = 1000, THREADS = 8 };

static const struct grey_phases PHASES = {.pore_peak = 60.0, .grain_peak = 180.0, .noise = 30.0};

static void noisy_slice(size_t slice, float *grey) {
  uint32_t state = (uint32_t)slice * 2654435761u + 1u;
  for (size_t i = 0; i < PIXELS; i++) {
    state = state * 1664525u + 1013904223u;
    grey[i] = (i % SIDE < SIDE / 2 ? 60.0f : 180.0f) + (float)(state >> 24) * 0.25f;
  }
}

/* OpenCV's threads were once set by each of the slices, which took down the arena the others were
 * in: a crash in one run of forty. */
static void check_kind(enum denoise kind) {
  static float one[SLICES][PIXELS], many[SLICES][PIXELS];
  size_t failed = 0;
  for (size_t i = 0; i < SLICES; i++) {
    noisy_slice(i, one[i]);
    memcpy(many[i], one[i], sizeof many[i]);
  }
#pragma omp parallel for num_threads(THREADS) schedule(dynamic) reduction(+ : failed)
  for (size_t i = 0; i < SLICES; i++)
    failed += denoise_slice(kind, &PHASES, (size_t[2]){SIDE, SIDE}, many[i]) != STATUS_OK;
  assert_int_equal(failed, 0);
  for (size_t i = 0; i < SLICES; i++)
    failed += denoise_slice(kind, &PHASES, (size_t[2]){SIDE, SIDE}, one[i]) != STATUS_OK;
  assert_int_equal(failed, 0);
  assert_memory_equal(one, many, sizeof one);
  assert_true(one[0][SIDE / 4] != one[0][3 * SIDE / 4]);
}

static void test_median(void **state) {
  (void)state;
  check_kind(DENOISE_MEDIAN);
}

static void test_nlm(void **state) {
  (void)state;
  check_kind(DENOISE_NLM);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_median),
      cmocka_unit_test(test_nlm),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
