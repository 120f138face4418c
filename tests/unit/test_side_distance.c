/* A sample that was wrapped: what lies beyond a side, as the walls of the other side do, is none of
 * its walls. Distances to planes, of a sample of 8 x 8 x 1 voxels of 1. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "common/side_distance.h"

enum { N = 8 };
static const size_t size[3] = {N, N, 1};
static const double unit[3] = {1.0, 1.0, 1.0};
static const bool both[3] = {true, true, false};
static float distance[N * N];

/* To a plane through `at` with a normal at an angle (degrees) to x, grain behind it. */
static void set_plane(double at, double angle) {
  const double nx = cos(angle * M_PI / 180.0), ny = sin(angle * M_PI / 180.0);
  for (size_t i = 0; i < N * N; i++)
    distance[i] = (float)(((double)(i % N) - at) * nx + ((double)(i / N) - 3.5) * ny);
}

static void test_wall_beyond_a_side(void **state) {
  (void)state;
  set_plane(-0.26,
            0.0); /* all pore; the wall is a quarter of a voxel out of the outermost centres */
  side_distance_unwrap(size, unit, both, distance);
  for (size_t i = 0; i < N * N; i++) {
    const size_t x = i % N;
    const size_t room = x < N - 1 - x ? x : N - 1 - x;
    assert_true(room > 2 || (isinf(distance[i]) && distance[i] > 0.0f));
  }
  set_plane(7.26, 180.0); /* the same in grain, at the other side */
  for (size_t i = 0; i < N * N; i++) distance[i] = -distance[i];
  side_distance_unwrap(size, unit, both, distance);
  for (size_t y = 0; y < N; y++) assert_true(isinf(distance[y * N + N - 1]));
}

static void test_wall_inside_stays(void **state) {
  (void)state;
  set_plane(0.3, 0.0); /* between the first centres and the second */
  side_distance_unwrap(size, unit, both, distance);
  for (size_t y = 1; y + 1 < N; y++) {
    assert_true(fabsf(distance[y * N] + 0.3f) < 1e-5f);
    assert_true(fabsf(distance[y * N + 1] - 0.7f) < 1e-5f);
  }
}

/* A wall at an angle meets the outermost layer of centres: the distance there is that to the line
 * in which it does, as its mirror image lies beyond. */
static void test_wall_at_an_angle(void **state) {
  (void)state;
  set_plane(-0.2, 50.0);
  float first[N];
  for (size_t y = 0; y < N; y++) first[y] = distance[y * N];
  side_distance_unwrap(size, unit, both, distance);
  for (size_t y = 4; y < 6; y++) /* in the pore, from where it lies outwards */
    assert_true(fabs((double)distance[y * N] - (double)first[y] / sin(50.0 * M_PI / 180.0)) < 1e-5);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_wall_beyond_a_side),
                                     cmocka_unit_test(test_wall_inside_stays),
                                     cmocka_unit_test(test_wall_at_an_angle)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
