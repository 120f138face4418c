/* The specific surface by Porod's law of balls that overlap at random, which is known (Chiu,
 * Stoyan, Kendall, Mecke 2013, Stochastic Geometry: S = 3 -ln(n) n / R at porosity n), after a blur
 * has taken the wedges between them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>
#include <omp.h>

#include "common/memory.h"
#include "ct2model/scanner/gaussian.h"
#include "ct2model/scanner/porod.h"

enum { SIDE = 112, BALLS = 300 };
#define RADIUS 9.0
#define BLUR 2.0
#define METRE 5e-6 /* of a voxel's shortest edge */

static double uniform(uint64_t *state) {
  *state = *state * 6364136223846793005U + 1442695040888963407U;
  return (double)(*state >> 11) * 0x1p-53;
}

/* Shares of grain, blurred, with voxels so many times as long along z; balls' centres lie outside
 * too. `lattice`: their radius on a lattice of 28 voxels, else 0. The threshold leaves the porosity
 * as it was, which is returned. */
static double draw(size_t longer, double lattice, struct restored *restored) {
  const bool apart = lattice > 0.0;
  const double radius = apart ? lattice : RADIUS;
  const size_t size[3] = {SIDE, SIDE, SIDE / longer}, n = size[0] * size[1] * size[2];
  const double left = 0.5 * BLUR; /* after the restoration */
  const double sigma[3] = {left, left, left / (double)longer}, box = SIDE + 2.0 * RADIUS;
  float *share = NULL, *work = NULL;
  uint64_t random = 5;
  size_t pores = 0;
  *restored = (struct restored){.scan = {.step = 1, .size = {size[0], size[1], size[2]}}};
  assert_int_equal(memory_allocate(&share, n, sizeof *share, "test"), STATUS_OK);
  assert_int_equal(memory_allocate(&work, n, sizeof *work, "test"), STATUS_OK);
  assert_int_equal(memory_allocate(&restored->scan.levels, n, 1, "test"), STATUS_OK);
  memset(share, 0, n * sizeof *share);
  for (int ball = 0; ball < (apart ? 4 * 4 * 4 : BALLS); ball++) {
    double at[3] = {14.2 + ball % 4 * 28, 14.2 + ball / 4 % 4 * 28, 14.2 + ball / 16 * 28};
    for (int d = 0; d < 3 && !apart; d++) at[d] = box * uniform(&random) - RADIUS;
    for (size_t row = 0; row < SIDE * size[2]; row++) {
      const double dy = (double)(row % SIDE) + 0.5 - at[1];
      const double dz = ((double)(row / SIDE) + 0.5) * (double)longer - at[2];
      if (dy * dy + dz * dz >= radius * radius) continue;
      for (size_t x = 0; x < SIDE; x++) {
        const double dx = (double)x + 0.5 - at[0];
        if (dx * dx + dy * dy + dz * dz < radius * radius) share[row * SIDE + x] = 1.0F;
      }
    }
  }
  for (size_t i = 0; i < n; i++) pores += share[i] < 0.5F;
  gaussian_filter(share, size, sigma, work, share);
  size_t counts[256] = {0}, below = 0;
  for (size_t i = 0; i < n; i++) {
    restored->scan.levels[i] = (uint8_t)lrintf(255.0F * share[i]);
    counts[restored->scan.levels[i]]++;
  }
  int level = 0;
  while (below + counts[level] / 2 < pores) below += counts[level++];
  restored->threshold = level - 0.5;
  const double porosity = (double)pores / (double)n;
  restored->void_ratio = porosity / (1.0 - porosity);
  memory_free(&share);
  memory_free(&work);
  return porosity;
}

static struct scanner scanner_of(double smooth_walls) {
  return (struct scanner){.known = true, .blur = BLUR * METRE, .smooth_walls = smooth_walls};
}

static void test_overlapping(void **state) {
  (void)state;
  for (size_t longer = 1; longer <= 2; longer++) {
    const struct scanner scanner = scanner_of(0.0);
    const double voxel[3] = {METRE, METRE, METRE * (double)longer};
    struct restored restored;
    const double n = draw(longer, 0.0, &restored), exact = -3.0 * log(n) * n / (RADIUS * METRE);
    double surface[2] = {0.9 * exact, 0.9 * exact}, error = NAN;
    for (int threads = 0; threads < 2; threads++) {
      omp_set_num_threads(1 + 3 * threads);
      assert_int_equal(porod_surface(&restored, &scanner, voxel, &surface[threads], &error),
                       STATUS_OK);
    }
    print_message("porosity %.3f: %+.2f %%\n", n, 100.0 * (surface[0] / exact - 1.0));
    assert_true(surface[0] == surface[1]);
    assert_true(fabs(surface[0] / exact - 1.0) < 0.04);
    assert_true(fabs(surface[0] - exact) < error && error < 0.1 * exact);
    restored_end(&restored);
  }
}

/* Slits between plane walls, 4 voxels wide and 20 apart in all three directions: what the law asks
 * for beyond the surface that they have is not theirs. */
static void test_plane_walls(void **state) {
  (void)state;
  const struct scanner scanner = {.known = true, .blur = 2.5 * METRE};
  const double voxel[3] = {METRE, METRE, METRE};
  struct restored restored = {.scan = {.step = 1, .size = {SIDE, SIDE, SIDE}}, .threshold = 127.5};
  const size_t n = (size_t)SIDE * SIDE * SIDE;
  size_t pores = 0;
  assert_int_equal(memory_allocate(&restored.scan.levels, n, 1, "test"), STATUS_OK);
  for (size_t i = 0; i < n; i++) {
    const bool pore = i % SIDE % 20 < 4 || i / SIDE % SIDE % 20 < 4 || i / SIDE / SIDE % 20 < 4;
    restored.scan.levels[i] = pore ? 0 : 255;
    pores += pore;
  }
  const double porosity = (double)pores / (double)n;
  restored.void_ratio = porosity / (1.0 - porosity);
  const double given = 6.0 * 16.0 * 16.0 / (20.0 * 20.0 * 20.0) / METRE;
  double surface = given, error = 0.0;
  assert_int_equal(porod_surface(&restored, &scanner, voxel, &surface, &error), STATUS_OK);
  print_message("plane walls: %+.2f %% +- %.1f %%\n", 100.0 * (surface / given - 1.0),
                100.0 * error / given);
  assert_true(surface == given && fabs(error / given - 0.2) < 1e-9);
  restored_end(&restored);
}

/* One slit in a box: its walls face one direction, and 256 directions do not tell their mean. */
static void test_one_direction(void **state) {
  (void)state;
  const struct scanner scanner = scanner_of(0.0);
  const double voxel[3] = {METRE, METRE, METRE}, given = 2.0 / (SIDE * METRE);
  struct restored restored = {
      .scan = {.step = 1, .size = {SIDE, SIDE, SIDE}}, .threshold = 127.5, .void_ratio = 0.5};
  const size_t n = (size_t)SIDE * SIDE * SIDE;
  double surface = given, error = 0.0;
  assert_int_equal(memory_allocate(&restored.scan.levels, n, 1, "test"), STATUS_OK);
  for (size_t i = 0; i < n; i++) restored.scan.levels[i] = i % SIDE / (SIDE / 3) == 1 ? 0 : 255;
  assert_int_equal(porod_surface(&restored, &scanner, voxel, &surface, &error), STATUS_OK);
  assert_true(surface == given && fabs(error / given - 0.2) < 1e-9);
  double grains = NAN;
  assert_int_equal(porod_grains(&restored, scanner.blur, voxel, given, &grains), STATUS_OK);
  assert_true(grains == 0.0);
  restored_end(&restored);
}

/* Where walls are smooth, or relief cannot be told from noise, the law counts what is missing at
 * the edges of balls that overlap, and nothing of balls that stand apart. */
static void test_smooth_walls(void **state) {
  (void)state;
  const struct scanner scanner = scanner_of(1.0);
  const double voxel[3] = {METRE, METRE, METRE};
  struct restored restored;
  const double n = draw(1, 0.0, &restored), exact = -3.0 * log(n) * n / (RADIUS * METRE);
  double surface = 0.9 * exact, error = NAN;
  assert_int_equal(porod_surface(&restored, &scanner, voxel, &surface, &error), STATUS_OK);
  print_message("overlapping: %+.2f %% +- %.1f %%\n", 100.0 * (surface / exact - 1.0),
                100.0 * error / surface);
  assert_true(fabs(surface / exact - 1.0) < 0.04);
  assert_true(surface - 0.9 * exact < error && error < 0.15 * exact); /* holds both */
  restored_end(&restored);
  (void)draw(1, RADIUS, &restored);
  const double given = surface = 0.95 * 4.0 * M_PI * pow(RADIUS, 2.0) / pow(28.0, 3.0) / METRE;
  assert_int_equal(porod_surface(&restored, &scanner, voxel, &surface, &error), STATUS_OK);
  assert_true(surface == given && fabs(error / given - 0.09) < 1e-9);
  restored_end(&restored);
}

/* Balls of 9 voxels on a lattice of 28 stand apart, balls of 14 touch. */
static void test_grains(void **state) {
  (void)state;
  const double voxel[3] = {METRE, METRE, METRE};
  for (int touch = 0; touch < 2; touch++) {
    const double radius = touch ? 14.0 : RADIUS;
    const double surface = 4.0 * M_PI * pow(radius, 2.0) / pow(28.0, 3.0) / METRE;
    struct restored restored;
    double grains = NAN;
    (void)draw(1, radius, &restored);
    assert_int_equal(porod_grains(&restored, BLUR * METRE, voxel, surface, &grains), STATUS_OK);
    print_message("balls of %g voxels: %g\n", radius, grains);
    assert_true(touch ? grains > 0.5 : grains == 0.0);
    restored_end(&restored);
  }
}

/* What the law does not know of stays. */
static void test_left_alone(void **state) {
  (void)state;
  const double voxel[3] = {METRE, METRE, METRE}, given = 2e4;
  struct scanner scanner = scanner_of(0.0);
  struct restored restored;
  double surface = given, error = 0.0;
  (void)draw(1, 0.0, &restored);
  scanner.narrow = true;
  assert_int_equal(porod_surface(&restored, &scanner, voxel, &surface, &error), STATUS_OK);
  assert_true(surface == given && fabs(error / given - 0.2) < 1e-9);
  scanner.narrow = false;
  restored.scan.size[2] = 6; /* hardly any pair along z */
  assert_int_equal(porod_surface(&restored, &scanner, voxel, &surface, &error), STATUS_OK);
  assert_true(surface == given && fabs(error / given - 0.2) < 1e-9);
  restored_end(&restored);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_overlapping),   cmocka_unit_test(test_plane_walls),
      cmocka_unit_test(test_one_direction), cmocka_unit_test(test_smooth_walls),
      cmocka_unit_test(test_grains),        cmocka_unit_test(test_left_alone)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
