/* Soil with pores below the sites, in method stokes; more in tests/verify/verify_micro.c. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "common/memory.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/stokes/soil_response.h"
#include "sphsolve/stokes/solver/step.h"

/* Layers across x: water from 0 to `water`, soil beyond. */
static void layers(size_t water, size_t soil, double n, double k, struct lattice *l) {
  *l = (struct lattice){.dimensions = 3, .size = {water + soil, 2, 2}};
  l->count = 4 * l->size[0];
  l->bulk_count = (double)l->count;
  l->fluid_count = l->count;
  for (int a = 0; a < 3; a++) l->spacing[a] = 1.0;
  assert_int_equal(memory_allocate(&l->kind, l->count, 1, "kind"), STATUS_OK);
  assert_int_equal(memory_allocate(&l->wall_distance, l->count, sizeof(float), "d"), STATUS_OK);
  assert_int_equal(lattice_soil_allocate(l), STATUS_OK);
  for (size_t s = 0; s < l->count; s++) {
    l->kind[s] = SITE_FLUID;
    l->wall_distance[s] = 100.0f;
    if (s % l->size[0] < water) continue;
    l->micro_porosity[s] = (float)n;
    l->micro_permeability[s] = (float)k;
  }
}

static double permeability(const struct lattice *l, int axis) {
  struct stokes_solver s;
  double driving[3] = {0.0};
  driving[axis] = 1.0;
  assert_int_equal(stokes_solver_build(l, NULL, 1.8, WALL_SUBVOXEL, 1.0, driving, &s), STATUS_OK);
  assert_int_equal(stokes_solver_run(&s, &(struct stokes_goal){.residual = 1e-6}), STATUS_OK);
  const double k = s.mean[axis];
  stokes_solver_free(&s);
  return k;
}

/* v and stress continuous at the surface; slip sqrt(k n) (Beavers, Joseph 1967). */
static void test_channel_over_soil(void **state) {
  (void)state;
  for (double k = 1e-8; k < 2.0; k *= 100.0) {
    struct lattice l;
    const double n = 0.35, h = 4.0, s = 4.0, r = sqrt(k / n), slip = sqrt(k * n) / tanh(s / r);
    const double exact = (h * h * h / 3.0 + h * k + slip * h * h + k * s + k * h) / (h + s);
    layers(8, 8, n, k, &l);
    assert_true(fabs(permeability(&l, 2) / exact - 1.0) < 0.003);
    lattice_free(&l);
  }
}

static void test_layers_in_series(void **state) {
  (void)state;
  for (double k = 1e-4; k < 2.0; k *= 10.0) {
    struct lattice l;
    layers(8, 8, 0.35, k, &l);
    assert_true(fabs(permeability(&l, 0) / (2.0 * k) - 1.0) < 0.01);
    lattice_free(&l);
  }
}

/* Uniform soil is Darcy's, whatever the direction. */
static void test_soil_alone(void **state) {
  (void)state;
  struct lattice l;
  layers(0, 8, 0.4, 1e-5, &l);
  for (int axis = 0; axis < 3; axis++)
    assert_true(fabs(permeability(&l, axis) / 1e-5 - 1.0) < 1e-5);
  lattice_free(&l);
}

static void test_resampled(void **state) {
  (void)state;
  struct lattice l, fine, coarse;
  layers(8, 8, 0.35, 1e-4, &l);
  assert_int_equal(lattice_resample(&l, 0.5, 0.0, &fine), STATUS_OK);
  assert_int_equal(lattice_resample(&l, 2.0, 0.0, &coarse), STATUS_OK);
  for (size_t i = 0; i < fine.size[0]; i++) {
    assert_true(lattice_is_soil(&fine, i) == (i >= 16));
    if (i >= 16) assert_float_equal(fine.micro_permeability[i], 1e-4f, 1e-9f);
  }
  for (size_t i = 0; i < coarse.size[0]; i++) assert_true(lattice_is_soil(&coarse, i) == (i >= 4));
  lattice_free(&fine);
  lattice_free(&coarse);
  lattice_free(&l);
}

/* The slope of one solution is that between two others; the share of the flux is the exact one. */
static double slope(const struct lattice *l, int axis, double *flux) {
  struct stokes_solver s;
  struct micropores_point point = {0};
  double driving[3] = {0.0};
  driving[axis] = 1.0;
  assert_int_equal(stokes_solver_build(l, NULL, 1.8, WALL_SUBVOXEL, 1.0, driving, &s), STATUS_OK);
  assert_int_equal(stokes_solver_run(&s, &(struct stokes_goal){.residual = 1e-6}), STATUS_OK);
  const double mean = s.mean[axis];
  assert_int_equal(soil_response_measure(&s, l, &point), STATUS_OK);
  assert_true(s.mean[axis] == mean);
  stokes_solver_free(&s);
  *flux = point.flux;
  return point.slope;
}

static void test_slope_of_one_solution(void **state) {
  (void)state;
  for (double k = 1e-6; k < 2.0; k *= 100.0) {
    struct lattice l, less, more;
    double flux;
    const double n = 0.35, h = 4.0, s = 4.0, r = sqrt(k / n), slip = sqrt(k * n) / tanh(s / r);
    layers(8, 8, n, k, &l);
    assert_int_equal(lattice_soil_scale(&l, exp(-0.1), &less), STATUS_OK);
    assert_int_equal(lattice_soil_scale(&l, exp(0.1), &more), STATUS_OK);
    const double between = log(permeability(&more, 2) / permeability(&less, 2)) / 0.2;
    assert_true(fabs(slope(&l, 2, &flux) / between - 1.0) < 0.06);
    const double all = h * h * h / 3.0 + h * k + slip * h * h + k * s + k * h; /* as below */
    assert_true(fabs(flux / (k * (s + h) / all) - 1.0) < 0.1);
    memory_free(&less.micro_permeability);
    memory_free(&more.micro_permeability);
    lattice_free(&l);
  }
}

/* All of the drop is in soil, or nothing but soil: k is proportional to k_micro. */
static void test_slope_is_one(void **state) {
  (void)state;
  for (int water = 0; water <= 8; water += 8) {
    struct lattice l;
    double flux;
    layers((size_t)water, 8, 0.35, 1e-3, &l);
    assert_true(fabs(slope(&l, 0, &flux) - 1.0) < 0.01);
    assert_true(fabs(flux - 8.0 / (8.0 + water)) < 0.02);
    lattice_free(&l);
  }
}

/* A site that covers a hundred others takes the mean of all of them, and one above walls alone what
 * lies beside it, also along an axis of one site. */
static void test_coarse(void **state) {
  (void)state;
  struct lattice fine, coarse = {.dimensions = 3, .size = {2, 1, 1}, .count = 2};
  uint8_t kinds[2] = {SITE_FLUID, SITE_FLUID};
  layers(0, 200, 0.2, 1e-3, &fine);
  for (size_t s = 0; s < fine.count; s++) {
    if (s % 200 >= 64 && s % 200 < 100) fine.micro_porosity[s] = 0.6f;
    if (s % 200 >= 100 && s % 200 < 198) fine.kind[s] = SITE_WALL;
  }
  for (int a = 0; a < 3; a++) coarse.spacing[a] = a == 0 ? 100.0 : 2.0;
  coarse.kind = kinds;
  assert_int_equal(lattice_soil_resample(&fine, &coarse), STATUS_OK);
  assert_true(fabs((double)coarse.micro_porosity[0] - (0.64 * 0.2 + 0.36 * 0.6)) < 1e-6);
  assert_true(fabs((double)coarse.micro_porosity[1] - 0.2) < 1e-6);
  memory_free(&coarse.micro_porosity);
  memory_free(&coarse.micro_permeability);
  fine.size[0] = 200, fine.size[1] = fine.size[2] = 1, fine.count = 200;
  for (size_t s = 100; s < 200; s++)
    fine.kind[s] = SITE_WALL; /* the nearest soil is round the box */
  assert_int_equal(lattice_soil_resample(&fine, &coarse), STATUS_OK);
  assert_true(fabs((double)coarse.micro_porosity[1] - 0.4) < 1e-6);
  memory_free(&coarse.micro_porosity);
  memory_free(&coarse.micro_permeability);
  lattice_free(&fine);
}

/* Balls at random, radius 3 to 5, which leave small pores that touch others over edges and corners
 * alone; a third is of `kind`, in place of pores. */
static void add_balls(uint8_t kind, unsigned *seed, size_t n, uint8_t *kinds) {
  for (size_t taken = 0; 3 * taken < n * n * n;) {
    double ball[4]; /* centre, radius */
    for (int i = 0; i < 4; i++) {
      *seed = *seed * 1664525u + 1013904223u;
      ball[i] = (*seed >> 8) / 16777216.0 * (i < 3 ? (double)n : 2.0) + (i < 3 ? 0.0 : 3.0);
    }
    for (size_t s = 0; s < n * n * n; s++) {
      const size_t at[3] = {s % n, s / n % n, s / n / n};
      double square = 0.0;
      for (int a = 0; a < 3; a++) {
        const double away = fabs((double)at[a] + 0.5 - ball[a]);
        square += pow(fmin(away, (double)n - away), 2);
      }
      if (kinds[s] != 0 || square > ball[3] * ball[3]) continue;
      kinds[s] = kind;
      taken++;
    }
  }
}

/* Iterations do not grow as soil lets less and less through, and are those of it closed. */
static void test_iterations_in_a_packing(void **state) {
  (void)state;
  enum { N = 32, GRAIN, SOIL };
  static uint8_t kinds[N * N * N];
  unsigned seed = 5;
  static struct scene scene;
  scene.stokes.kernel = KERNEL_CUBIC; /* the default */
  long closed = 0;
  add_balls(GRAIN, &seed, N, kinds);
  add_balls(SOIL, &seed, N, kinds);
  for (double k = 0.0; k < 1.0; k = k == 0.0 ? 1e-8 : k * 100.0) {
    struct lattice l;
    struct stokes_solver s;
    layers(N * N * N / 4, 0, 0.0, 0.0, &l);
    for (int a = 0; a < 3; a++) l.size[a] = N;
    for (size_t i = 0; i < l.count; i++) {
      const bool wall = kinds[i] == GRAIN || (kinds[i] == SOIL && k == 0.0);
      l.kind[i] = wall ? SITE_WALL : SITE_FLUID;
      l.wall_distance[i] = wall ? -0.5f : 0.5f;
      l.fluid_count -= wall;
      l.wall_count += wall;
      if (wall || kinds[i] != SOIL) continue;
      l.micro_porosity[i] = 0.35f;
      l.micro_permeability[i] = (float)k;
    }
    if (k == 0.0) memory_free(&l.micro_porosity), memory_free(&l.micro_permeability);
    const double driving[3] = {0.0, 0.0, 1.0};
    assert_int_equal(stokes_solver_build(&l, &scene, 1.8, WALL_SUBVOXEL, 1.0, driving, &s),
                     STATUS_OK);
    assert_int_equal(stokes_solver_run(&s, &(struct stokes_goal){.mean = 1e-4}), STATUS_OK);
    if (k == 0.0) closed = s.iterations;
    assert_true((double)s.iterations <= 1.5 * (double)closed);
    stokes_solver_free(&s);
    lattice_free(&l);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_coarse),           cmocka_unit_test(test_slope_of_one_solution),
      cmocka_unit_test(test_slope_is_one),     cmocka_unit_test(test_channel_over_soil),
      cmocka_unit_test(test_layers_in_series), cmocka_unit_test(test_soil_alone),
      cmocka_unit_test(test_resampled),        cmocka_unit_test(test_iterations_in_a_packing)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
