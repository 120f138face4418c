/* The uncertainty of a blur that few surfaces tell: octants that agree, that do not, and one alone.
 */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "ct2model/scanner/few_surfaces.h"
#include "ct2model/scanner/windows.h"

enum { SIDE = 48, N = SIDE * SIDE * SIDE };
static const double REACH = 5.0, TILT = 0.1;

/* Walls across x, grain between them and pore beyond: one in the middle of each half of the window,
 * of that blur (voxels; NAN: none). */
static double error_of(const double blur[2], size_t region_side, size_t windows) {
  static float grey[N], distance[N];
  const struct region region = {.size = {region_side, region_side, region_side}};
  struct windows all = {.region = &region, .stretch = {1.0, 1.0, 1.0}, .unit = 1.0};
  for (size_t i = 0; i < N; i++) {
    const double x = (double)(i % SIDE) + 0.5, y = (double)(i / SIDE % SIDE) - 0.5 * SIDE;
    const int half = x > 0.5 * SIDE; /* tilted, so that voxels are at all distances */
    const double d = ((half ? x - 0.75 * SIDE : 0.25 * SIDE - x) + TILT * y) / hypot(1.0, TILT);
    const int here = isfinite(blur[half]);
    const double deviation = hypot(blur[half], sqrt(1.0 / 12.0));
    distance[i] = (float)(here ? d : 10.0);
    grey[i] = here ? (float)(0.5 * erfc(d / deviation / sqrt(2.0))) : 0.0F;
  }
  for (; all.count < windows; all.count++)
    all.window[all.count] = (struct window){
        .size = {SIDE, SIDE, SIDE}, .grey = grey, .smooth = grey, .distance = distance};
  return few_surfaces_error(&all, REACH);
}

static void test_octants_agree(void **state) {
  (void)state;
  const double blur[2] = {1.5, 1.5};
  assert_true(error_of(blur, SIDE, 1) < 0.01); /* but for where voxels lie */
}

/* Half of the octants have 1.2, half 2: the blur of all is some 1.6, and moves by .06 for each of
 * them left out, sqrt(7 / 8 * 8 * .06^2) / 1.6 = .1. */
static void test_octants_differ(void **state) {
  (void)state;
  const double blur[2] = {1.2, 2.0};
  const double error = error_of(blur, SIDE, 1);
  assert_true(error > 0.06 && error < 0.2);
  assert_true(fabs(error_of(blur, SIDE, WINDOWS) / error - 1.0) < 1e-6); /* the same window often */
}

/* Of a region twice as wide the window is one octant. */
static void test_one_octant(void **state) {
  (void)state;
  const double blur[2] = {1.5, 1.5};
  assert_true(error_of(blur, 2 * SIDE, 1) >= 0.25);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_octants_agree),
      cmocka_unit_test(test_octants_differ),
      cmocka_unit_test(test_one_octant),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
