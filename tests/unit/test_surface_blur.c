/* A surface blurred once more: flat walls stay, round grains shrink by sigma^2 / R as curvature
 * flow says, narrow pores close, the void ratio stays. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/memory.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/geometry/surface_blur.h"

#define H 2e-6 /* m */
enum { NX = 64, NY = 32, NZ = 32 };

static struct lattice lattice_of(double (*distance)(const double at[3])) {
  struct lattice l = {.dimensions = 3,
                      .size = {NX, NY, NZ},
                      .spacing = {H, H, H},
                      .count = (size_t)NX * NY * NZ,
                      .bulk_count = (double)NX * NY * NZ};
  assert_int_equal(memory_allocate(&l.kind, l.count, 1, "test"), STATUS_OK);
  assert_int_equal(memory_allocate(&l.wall_distance, l.count, sizeof(float), "test"), STATUS_OK);
  for (size_t s = 0; s < l.count; s++) {
    const double at[3] = {(double)(s % NX) + 0.5, (double)(s / NX % NY) + 0.5,
                          (double)(s / NX / NY) + 0.5};
    const double d = distance(at);
    l.wall_distance[s] = (float)(d * H);
    l.kind[s] = d > 0.0 ? SITE_FLUID : SITE_WALL;
    *(d > 0.0 ? &l.fluid_count : &l.wall_count) += 1;
  }
  return l;
}

static double ball(const double at[3], double x, double radius) {
  return sqrt(pow(at[0] - x, 2.0) + pow(at[1] - 16.0, 2.0) + pow(at[2] - 16.0, 2.0)) - radius;
}

static double two_balls(const double at[3]) {
  return fmin(ball(at, 16.0, 12.0), ball(at, 48.0, 6.0));
}

/* Pores 16 and 1 sites wide between flat grains. */
static double slits(const double at[3]) {
  return fmax(8.0 - fabs(at[0] - 16.0), 0.5 - fabs(at[0] - 48.5));
}

/* Mean displacement, in spacings, of the surface of sites within a spacing of it and x in [low,
 * high]: positive where the pore grows. */
static double moved(const struct lattice *from, const struct lattice *to, double low, double high) {
  double sum = 0.0, n = 0.0;
  for (size_t s = 0; s < from->count; s++) {
    const double x = (double)(s % NX) + 0.5;
    if (x < low || x > high || fabs((double)from->wall_distance[s]) > H) continue;
    sum += (double)(to->wall_distance[s] - from->wall_distance[s]) / H;
    n += 1.0;
  }
  return sum / n;
}

static void test_balls(void **state) {
  (void)state;
  struct lattice balls = lattice_of(two_balls), blurred;
  double scale;
  assert_int_equal(lattice_blur(&balls, 1.5 * H, &balls, &scale, &blurred), STATUS_OK);
  const double large = moved(&balls, &blurred, 3.0, 29.0);
  const double small = moved(&balls, &blurred, 41.0, 55.0);
  const double wanted = 1.5 * 1.5 * (1.0 / 6.0 - 1.0 / 12.0);
  print_message("large ball %+.4f, small ball %+.4f spacings; difference %.4f, wanted %.4f\n",
                large, small, small - large, wanted);
  assert_true(small > 0.0 && large < 0.0);
  assert_true(fabs((small - large) / wanted - 1.0) < 0.1);
  assert_true(fabs(lattice_void_ratio(&blurred, 0.0) / lattice_void_ratio(&balls, 0.0) - 1.0) <
              1e-3);
  assert_int_equal(blurred.fluid_count + blurred.wall_count, balls.count);
  lattice_free(&blurred);
  lattice_free(&balls);
}

/* Walls so thin that they are gone where all move by the width of the blur. */
static double sheets(const double at[3]) {
  return fabs(at[0] - 32.3) - 0.6;
}

static void test_sheets(void **state) {
  (void)state;
  struct lattice walls = lattice_of(sheets), blurred;
  double scale;
  assert_int_equal(lattice_blur(&walls, 3.0 * H, &walls, &scale, &blurred), STATUS_OK);
  for (size_t s = 0; s < blurred.count; s++) assert_true(isfinite(blurred.wall_distance[s]));
  assert_true(fabs(lattice_void_ratio(&blurred, 0.0) / lattice_void_ratio(&walls, 0.0) - 1.0) <
              0.2);
  lattice_free(&blurred);
  lattice_free(&walls);
}

static void test_slits(void **state) {
  (void)state;
  struct lattice walls = lattice_of(slits), blurred;
  double scale;
  assert_int_equal(lattice_blur(&walls, 1.5 * H, &walls, &scale, &blurred), STATUS_OK);
  size_t narrow = 0, wide = 0;
  for (size_t s = 0; s < blurred.count; s++)
    *(s % NX < NX / 2 ? &wide : &narrow) += blurred.kind[s] == SITE_FLUID;
  assert_int_equal(narrow, 0);
  /* What the narrow one has lost the wide one has: half of it on each side. */
  print_message("flat walls moved by %.4f spacings\n", moved(&walls, &blurred, 3.0, 29.0));
  assert_true(fabs(moved(&walls, &blurred, 3.0, 29.0) - 0.5) < 0.05);
  assert_int_equal(wide, 16 * NY * NZ); /* to the sites' next centres it is as far */
  lattice_free(&blurred);
  lattice_free(&walls);
}

/* A slit of 16 sites, its walls this far beyond a site. */
static double beyond_site;
static double flat(const double at[3]) {
  return 8.0 - fabs(at[0] - 24.0 - beyond_site);
}

/* Flat walls stay where they are, and so do distances about them, wherever walls lie among sites:
 * half-way between two, a voxel's average has no site that says where. */
static void test_flat_walls_stay(void **state) {
  (void)state;
  for (int part = 0; part < 4; part++) {
    beyond_site = 0.25 * part;
    struct lattice walls = lattice_of(flat), blurred;
    double scale, most = 0.0;
    assert_int_equal(lattice_blur(&walls, 0.9 * H, &walls, &scale, &blurred), STATUS_OK);
    for (size_t s = 0; s < walls.count; s++)
      if (fabs((double)walls.wall_distance[s]) < 1.9 * H)
        most = fmax(most, fabs((double)(blurred.wall_distance[s] - walls.wall_distance[s])) / H);
    print_message("walls %.2f beyond a site: distances change by %.3f at most\n", beyond_site,
                  most);
    assert_true(most < 0.05);
    lattice_free(&blurred);
    lattice_free(&walls);
  }
}

static void test_level(void **state) {
  (void)state;
  struct lattice balls = lattice_of(two_balls), level, blurred;
  double scale;
  assert_int_equal(lattice_resample(&balls, 4.0 * H, 0.0, &level), STATUS_OK);
  assert_int_equal(lattice_blur(&balls, 0.45 * H, &level, &scale, &blurred), STATUS_OK);
  assert_memory_equal(blurred.size, level.size, sizeof level.size);
  assert_true(fabs(scale - 0.25) < 1e-6); /* 0.9 spacings is the least the sites hold */
  lattice_free(&blurred);
  assert_int_equal(lattice_blur(&balls, 2.0 * H, &level, &scale, &blurred), STATUS_OK);
  assert_true(scale == 1.0);
  lattice_free(&blurred);
  lattice_free(&level);
  lattice_free(&balls);
}

/* Rows longer than the pieces they are blurred in: each copy of a body along them has the same
 * bits. */
static void test_long_rows(void **state) {
  (void)state;
  enum { LONG = 1536, COPY = 64, WIDE = 6 };
  struct lattice l = {.dimensions = 3,
                      .size = {LONG, WIDE, WIDE},
                      .spacing = {H, H, H},
                      .count = (size_t)LONG * WIDE * WIDE,
                      .bulk_count = (double)LONG * WIDE * WIDE};
  struct lattice blurred;
  double scale;
  assert_int_equal(memory_allocate(&l.kind, l.count, 1, "test"), STATUS_OK);
  assert_int_equal(memory_allocate(&l.wall_distance, l.count, sizeof(float), "test"), STATUS_OK);
  for (size_t s = 0; s < l.count; s++) {
    const double x = (double)(s % COPY) + 0.5, y = (double)(s / LONG % WIDE) + 0.5;
    const double d = fabs(x - 30.0) - 8.0 - sin(2.0 * M_PI * y / WIDE);
    l.wall_distance[s] = (float)(d * H);
    l.kind[s] = d > 0.0 ? SITE_FLUID : SITE_WALL;
    *(d > 0.0 ? &l.fluid_count : &l.wall_count) += 1;
  }
  assert_int_equal(lattice_blur(&l, 1.5 * H, &l, &scale, &blurred), STATUS_OK);
  size_t changed = 0;
  for (size_t s = 0; s < l.count; s++) {
    const size_t first = s / LONG * LONG + s % COPY;
    assert_true(blurred.wall_distance[s] == blurred.wall_distance[first]);
    changed += fabsf(blurred.wall_distance[s] - l.wall_distance[s]) > 1e-3f * (float)H;
  }
  assert_true(changed > l.count / 20);
  lattice_free(&blurred);
  lattice_free(&l);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_balls),           cmocka_unit_test(test_long_rows),
      cmocka_unit_test(test_slits),           cmocka_unit_test(test_sheets),
      cmocka_unit_test(test_flat_walls_stay), cmocka_unit_test(test_level)};
  return cmocka_run_group_tests_name("surface_blur", tests, NULL, NULL);
}
