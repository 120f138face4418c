/* Errors, memory, kernels, statistics: the small rooms everything stands on. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/resource.h>

#include <cmocka.h>

#include "common/error.h"
#include "common/uncertainty_parts.h"
#include "common/kernel.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/statistics.h"
#include "common/threads.h"
#include "tests/unit/nth_fails.h"

static enum status inner(void) {
  return FAIL(STATUS_INPUT, "line 3: no number");
}
static enum status outer(void) {
  enum status status;
  TRY(inner());
cleanup:
  return error_context(status, "scene.cfg");
}

static void test_error(void **state) {
  (void)state;
  assert_int_equal(outer(), STATUS_INPUT);
  assert_string_equal(error_message(), "scene.cfg: line 3: no number");
  assert_non_null(strstr(error_trail(), " < "));
  /* The first failure is the cause. */
  (void)FAIL(STATUS_RUN, "second");
  assert_string_equal(error_message(), "scene.cfg: line 3: no number");
  error_clear();
  assert_string_equal(error_message(), "");
}

static void test_memory(void **state) {
  (void)state;
  double *values = NULL;
  size_t before = memory_in_use();
  assert_int_equal(memory_allocate(&values, 1000, sizeof *values, "values"), STATUS_OK);
  assert_int_equal((uintptr_t)values % 64, 0);
  for (int i = 0; i < 1000; i++) assert_true(values[i] == 0);
  values[999] = 7;
  assert_int_equal(memory_resize(&values, 2000, sizeof *values, "values"), STATUS_OK);
  assert_true(values[999] == 7 && values[1999] == 0);
  assert_int_equal(memory_in_use() - before, 2000 * sizeof *values);
  memory_free(&values);
  assert_null(values);
  assert_int_equal(memory_in_use(), before);
  assert_int_equal(memory_allocate(&values, SIZE_MAX / 2, 16, "far too much"), STATUS_RUN);
  error_clear();
  memory_set_limit(before + 1000);
  assert_int_equal(memory_allocate(&values, 1001, 1, "a field"), STATUS_RUN);
  assert_non_null(strstr(error_message(), "--max-memory"));
  error_clear();
  memory_set_limit(0);
  nth_fails_left = 2;
  memory_ask_fails(nth_fails);
  assert_int_equal(memory_allocate(&values, 1, 1, "first"), STATUS_OK);
  memory_free(&values);
  assert_int_equal(memory_allocate(&values, 1, 1, "second"), STATUS_RUN);
  error_clear();
  memory_ask_fails(NULL);
}

/* Integral of W over space, and W' against the difference quotient of W. */
static void test_kernels(void **state) {
  (void)state;
  for (int kernel = KERNEL_QUINTIC; kernel <= KERNEL_WENDLAND; kernel++)
    for (int dimensions = kernel == KERNEL_WENDLAND ? 2 : 1; dimensions <= 3; dimensions++) {
      double h = 0.7, reach = h * kernel_support_ratio((enum kernel)kernel), integral = 0;
      double slopes = 0, square = 0; /* of -r W' and of r^2 W */
      enum { N = 20000 };
      for (int i = 0; i < N; i++) {
        double r = (i + 0.5) * reach / N;
        double shell = dimensions == 1 ? 2 : dimensions == 2 ? 2 * M_PI * r : 4 * M_PI * r * r;
        const double w = kernel_w((enum kernel)kernel, dimensions, r, h);
        integral += w * shell * reach / N;
        square += r * r / (h * h) * w * shell * reach / N;
        slopes -= r * kernel_dw((enum kernel)kernel, dimensions, r, h) * shell * reach / N;
      }
      assert_true(fabs(slopes - dimensions) < 1e-6); /* the first moment of grad W, by parts */
      if (kernel == KERNEL_WENDLAND) /* beta functions: 1/5, 5/36 of the support squared */
        assert_true(fabs(square - (dimensions == 3 ? 4.0 / 5 : 5.0 / 9)) < 1e-6);
      if (kernel == KERNEL_QUINTIC && dimensions == 1) /* six boxes of width h, 1/12 each */
        assert_true(fabs(square - 0.5) < 1e-6);
      if (fabs(integral - 1) > 1e-6)
        fail_msg("kernel %d in %d-D integrates to %.9f", kernel, dimensions, integral);
      for (double r = 0.01; r < reach; r += 0.037) {
        double e = 1e-6;
        double slope = (kernel_w((enum kernel)kernel, dimensions, r + e, h) -
                        kernel_w((enum kernel)kernel, dimensions, r - e, h)) /
                       (2 * e);
        assert_true(fabs(slope - kernel_dw((enum kernel)kernel, dimensions, r, h)) < 1e-6);
      }
      assert_true(kernel_w((enum kernel)kernel, dimensions, 1.000001 * reach, h) == 0);
      assert_true(kernel_dw((enum kernel)kernel, dimensions, 1.01 * reach, h) == 0);
    }
}

static void test_statistics(void **state) {
  (void)state;
  double many[] = {1, 1e100, 1, -1e100};
  assert_true(sum_compensated(many, 4) == 2);
  double x[] = {1, 5, 10}, y[] = {2.1, 10.0, 20.1};
  struct linear_fit fit;
  assert_int_equal(fit_linear(x, y, 3, 1, &fit), STATUS_OK);
  assert_true(fabs(fit.slope - (2.1 + 50 + 201) / 126) < 1e-12);
  assert_int_equal(fit_linear(x, y, 3, 0, &fit), STATUS_OK);
  assert_true(fabs(fit.intercept + fit.slope * 16. / 3 - 32.2 / 3) < 1e-12);
  assert_true(fit.r_squared > 0.999 && fit.slope_error > 0);
  double same[] = {2, 2, 2};
  assert_int_equal(fit_linear(same, y, 3, 0, &fit), STATUS_INPUT);
  error_clear();
  assert_true(fabs(student_t95(1) - 12.706) < 0.01 && fabs(student_t95(10) - 2.228) < 0.003 &&
              fabs(student_t95(1e9) - 1.960) < 0.001);
  double counts[4], values[] = {0, 0.1, 0.9, 1, 2};
  histogram(values, 5, 0, 1, 4, counts);
  assert_true(counts[0] == 2 && counts[3] == 2 && counts[1] == 0);
  assert_true(quantile(values, 5, 0.5) == 0.9 && isnan(quantile(values, 0, 0.5)));
  /* White noise: the error of the mean is sigma / sqrt(n). */
  enum { N = 10000 };
  static double noise[N];
  uint64_t seed = 1;
  for (int i = 0; i < N; i++) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    noise[i] = (double)(seed >> 11) / 9007199254740992.0;
  }
  double mean, error;
  batch_means(noise, N, &mean, &error);
  double expected = 1 / sqrt(12.0 * N);
  assert_true(fabs(mean - 0.5) < 4 * expected && error > 0.7 * expected && error < 1.4 * expected);
}

/* Shares add up as squares; what is unknown does not count, and slopes are no shares. */
static void test_uncertainty_parts_add_up(void **state) {
  (void)state;
  struct uncertainty_parts parts = uncertainty_parts_none();
  assert_true(isnan(uncertainty_parts_total(&parts, parts.resolution)));
  parts.scan = 0.3, parts.steadiness = 0.4, parts.sides_closed = 7.0;
  parts.blur_assumed = 8.0, parts.sides_unknown = 1.0;
  assert_true(fabs(uncertainty_parts_total(&parts, parts.resolution) - 0.5) < 1e-15);
  assert_true(fabs(uncertainty_parts_total(&parts, 1.2) - 1.3) < 1e-15);
  assert_string_equal(uncertainty_part_names[UNCERTAINTY_SHARES - 1], "steadiness");
  assert_string_equal(uncertainty_part_names[UNCERTAINTY_PARTS - 1], "sides_unknown");
  assert_true(
      parts.value[UNCERTAINTY_SHARES - 1] == 0.4 && parts.value[UNCERTAINTY_PARTS - 3] == 7.0 &&
      parts.value[UNCERTAINTY_PARTS - 2] == 8.0 && parts.value[UNCERTAINTY_PARTS - 1] == 1.0);
}

/* x raises k by a tenth and y takes it back: that is no sample without sides. */
static void test_sides_do_not_cancel(void **state) {
  (void)state;
  assert_true(fabs(uncertainty_share_of_sides((const double[]){1.0, 1.1, 1.0}, 3) -
                   hypot(0.1, 1.0 - 1.0 / 1.1)) < 1e-15);
  assert_true(fabs(uncertainty_share_of_sides((const double[]){2.0, 1.8, 1.6}, 3) - 0.2) <
              1e-15); /* both lower it */
  assert_true(fabs(uncertainty_share_of_sides((const double[]){2.0, 0.0, 1.6}, 3) - 0.2) < 1e-15);
  assert_true(isnan(uncertainty_share_of_sides((const double[]){0.0, 1.0, 1.0}, 3)));
  assert_true(uncertainty_share_of_sides((const double[]){1.0, 0.9, 0.0}, 3) == 1.0); /* shut */
  assert_true(isnan(uncertainty_share_of_sides((const double[]){1.0, 0.9, NAN}, 3)));
}

static void test_threads_that_cannot_start(void **state) {
  (void)state;
  const int before = omp_get_max_threads();
  log_start("test_common", LOG_QUIET);
  assert_int_equal(threads_check(), STATUS_OK);
  omp_set_num_threads(100000);
  assert_int_equal(threads_check(), STATUS_USAGE);
  assert_non_null(strstr(error_message(), "OMP_NUM_THREADS asks for 100000 threads; 4096 at most"));
  error_clear();
  omp_set_num_threads(before);
  struct rlimit stack, small;
  assert_int_equal(getrlimit(RLIMIT_STACK, &stack), 0);
  small = stack;
  small.rlim_cur = 128 << 10;
  assert_int_equal(setrlimit(RLIMIT_STACK, &small), 0);
  assert_int_equal(threads_check(), STATUS_RUN);
  assert_non_null(strstr(error_message(), "the stack may hold 128 kB only"));
  error_clear();
  assert_int_equal(setrlimit(RLIMIT_STACK, &stack), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_uncertainty_parts_add_up),
                                     cmocka_unit_test(test_sides_do_not_cancel),
                                     cmocka_unit_test(test_error),
                                     cmocka_unit_test(test_memory),
                                     cmocka_unit_test(test_kernels),
                                     cmocka_unit_test(test_statistics),
                                     cmocka_unit_test(test_threads_that_cannot_start)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
