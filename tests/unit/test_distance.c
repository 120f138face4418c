/* Wall distances from the grain volume fraction: planes at any angle and offset, spheres, fields
 * that are blurred over several voxels. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/error.h"
#include "sphsolve/geometry/distance.h"

enum { N = 16, SITES = N * N * N, SAMPLES = 12 };
static float fraction[SITES], distance[SITES];
static const size_t size[3] = {N, N, N};
static const bool open_sides[3] = {false, false, false};

/* A sphere, or the half space in front of a plane where the radius is 0. */
struct body {
  double at[3], normal[3], radius, blur; /* blur: width of a linear ramp in place of the edge, m */
};

static double to_body(const struct body *body, const double x[3]) {
  double along = 0, square = 0;
  for (int a = 0; a < 3; a++) {
    along += (x[a] - body->at[a]) * body->normal[a];
    square += (x[a] - body->at[a]) * (x[a] - body->at[a]);
  }
  return body->radius > 0 ? sqrt(square) - body->radius : along;
}

static double share_of(const struct body *body, const double spacing[3], const size_t at[3]) {
  double sum = 0, middle[3];
  for (int a = 0; a < 3; a++) middle[a] = ((double)at[a] + 0.5) * spacing[a];
  const bool cut = fabs(to_body(body, middle)) < 1.1 * spacing[0];
  const int n = body->blur > 0 || !cut ? 1 : SAMPLES;
  for (int q = 0; q < n * n * n; q++) {
    const int sub[3] = {q % n, q / n % n, q / n / n};
    double x[3];
    for (int a = 0; a < 3; a++) x[a] = ((double)at[a] + (sub[a] + 0.5) / n) * spacing[a];
    const double d = to_body(body, x);
    sum += body->blur > 0 ? fmin(fmax(0.5 - d / body->blur, 0), 1) : d < 0;
  }
  return sum / (n * n * n);
}

/* The largest error of a distance of at most 2 spacings, in spacings, away from the sides. */
static double worst(const struct body *body, const double spacing[3]) {
  double most = 0;
  for (size_t q = 0; q < SITES; q++) {
    const size_t at[3] = {q % N, q / N % N, q / N / N};
    fraction[q] = (float)share_of(body, spacing, at);
  }
  assert_int_equal(
      distance_from_fraction(size, spacing, open_sides, 0, size[2], fraction, distance), STATUS_OK);
  for (size_t q = 0; q < SITES; q++) {
    const size_t at[3] = {q % N, q / N % N, q / N / N};
    double x[3];
    bool inside = true;
    for (int a = 0; a < 3; a++) {
      x[a] = ((double)at[a] + 0.5) * spacing[a];
      inside = inside && at[a] >= 3 && at[a] < N - 3;
    }
    const double d = to_body(body, x);
    if (inside && fabs(d) < 2 * spacing[0])
      most = fmax(most, fabs((double)distance[q] - d) / spacing[0]);
  }
  return most;
}

static void test_planes(void **state) {
  (void)state;
  const double cube[3] = {2e-6, 2e-6, 2e-6}, flat[3] = {2e-6, 2.4e-6, 1.8e-6};
  const double normals[][3] = {{1, 0, 0}, {0, 0, -1}, {0.6, 0.8, 0}, {0.48, -0.6, 0.64}};
  for (size_t n = 0; n < sizeof normals / sizeof *normals; n++)
    for (int k = 0; k < 5; k++) {
      struct body body = {.at = {16e-6 + 0.4e-6 * k, 16.3e-6, 15.9e-6}};
      for (int a = 0; a < 3; a++) body.normal[a] = normals[n][a];
      /* A plane along the voxels is exact but for the samples that its share is counted by. */
      const double bound = n < 2 ? 0.5 / SAMPLES : 0.1;
      assert_true(worst(&body, cube) < bound);
      assert_true(worst(&body, flat) < bound * 1.2);
    }
}

static void test_spheres(void **state) {
  (void)state;
  const double cube[3] = {1e-6, 1e-6, 1e-6};
  for (int k = 0; k < 4; k++) {
    const struct body body = {.at = {8e-6 + 0.2e-6 * k, 8.1e-6, 7.7e-6}, .radius = 4.2e-6};
    /* The foot straight before a site is at most half a diagonal aside, where the tangent plane of
     * what is 2 spacings inside has left the sphere by its square over 2 (R - 2); a cut of a voxel
     * with and without the sphere's bend differs by 1/(12 R). */
    assert_true(worst(&body, cube) < 0.5 / (2 * (4.2 - 2)) + 1 / (12 * 4.2));
  }
}

/* Four voxels wide: the surface is where the fraction is 1/2. */
static void test_blurred(void **state) {
  (void)state;
  const double cube[3] = {1e-6, 1e-6, 1e-6};
  for (int k = 0; k < 5; k++) {
    const struct body body = {.at = {8e-6 + 0.2e-6 * k, 0, 0}, .normal = {1, 0, 0}, .blur = 4e-6};
    assert_true(worst(&body, cube) < 1e-3);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_planes), cmocka_unit_test(test_spheres),
                                     cmocka_unit_test(test_blurred)};
  return cmocka_run_group_tests_name("distance", tests, NULL, NULL);
}
