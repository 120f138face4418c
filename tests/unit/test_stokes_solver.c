/* Method stokes against exact solutions on hand-made lattices. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "common/memory.h"
#include "sphsolve/methods/stokes_solver.h"

typedef double distance_function(const double at[3], double parameter);

/* Unit cube (or slab) of nx x ny x nz sites with an analytic wall distance. */
static void lattice_fill(struct lattice *lattice, const size_t size[3], double spacing,
                         distance_function *distance, double parameter) {
  memset(lattice, 0, sizeof *lattice);
  lattice->dimensions = 3;
  lattice->count = size[0] * size[1] * size[2];
  lattice->bulk_count = lattice->count;
  for (int a = 0; a < 3; a++) lattice->size[a] = size[a], lattice->spacing[a] = spacing;
  assert_int_equal(memory_allocate(&lattice->kind, lattice->count, 1, "kind"), STATUS_OK);
  assert_int_equal(memory_allocate(&lattice->wall_distance, lattice->count, sizeof(float), "d"),
                   STATUS_OK);
  for (size_t s = 0; s < lattice->count; s++) {
    const size_t at[3] = {s % size[0], s / size[0] % size[1], s / size[0] / size[1]};
    const double x[3] = {((double)at[0] + 0.5) * spacing, ((double)at[1] + 0.5) * spacing,
                         ((double)at[2] + 0.5) * spacing};
    const double d = distance(x, parameter);
    lattice->wall_distance[s] = (float)d;
    lattice->kind[s] = d > 0.0 ? SITE_FLUID : SITE_WALL;
    if (d > 0.0)
      lattice->fluid_count++;
    else
      lattice->wall_count++;
  }
}

static void lattice_empty(struct lattice *lattice) {
  memory_free(&lattice->kind);
  memory_free(&lattice->wall_distance);
}

static double permeability(const size_t size[3], double spacing, distance_function *distance,
                           double parameter, enum wall_scheme wall) {
  struct lattice lattice;
  struct stokes_solver solver;
  const double driving[3] = {0.0, 0.0, -2.0};
  lattice_fill(&lattice, size, spacing, distance, parameter);
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9 * spacing, wall, 1.0, driving, &solver),
                   STATUS_OK);
  assert_int_equal(stokes_solver_run(&solver, 1e-5), STATUS_OK);
  const double k = -solver.mean[2] * spacing * spacing;
  stokes_solver_free(&solver);
  lattice_empty(&lattice);
  return k;
}

/* Simple cubic spheres, one a unit cell, of volume fraction c. */
static double sphere_distance(const double at[3], double c) {
  const double radius = cbrt(0.75 * c / M_PI);
  double least = INFINITY;
  for (int i = 0; i < 27; i++) {
    const int image[3] = {i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1};
    double square = 0.0;
    for (int a = 0; a < 3; a++) square += pow(at[a] - 0.5 - image[a], 2);
    least = fmin(least, sqrt(square) - radius);
  }
  return least;
}

/* Zick, Homsy 1982 (drag K): k/a^2 = 2 / (9 c K); one per cent at 24 sites a side. */
static void test_spheres_within_one_per_cent(void **state) {
  (void)state;
  const double c = 0.216, drag = 7.4419, radius = cbrt(0.75 * c / M_PI);
  const size_t size[3] = {24, 24, 24};
  const double k = permeability(size, 1.0 / 24.0, sphere_distance, c, WALL_SUBVOXEL);
  assert_true(fabs(k / (radius * radius * 2.0 / (9.0 * c * drag)) - 1.0) < 0.01);
}

/* Between planes w apart: k = w^3 / (12 L) for a period L = w + 3. `shift` moves the slit. */
#define SLIT_WIDTH 4.0
static double slit_distance(const double at[3], double shift) {
  const double x = at[0] - shift;
  return x < SLIT_WIDTH ? fmin(x, SLIT_WIDTH - x) : -fmin(x - SLIT_WIDTH, 7.0 - x);
}
static double slit_shifted(const double at[3], double shift) {
  const double wrapped[3] = {at[0] < shift ? at[0] + 7.0 : at[0], at[1], at[2]};
  return slit_distance(wrapped, shift);
}

static void test_slit_at_any_shift(void **state) {
  (void)state;
  const size_t size[3] = {7, 1, 2}; /* narrower than the support: right by wrapping */
  const double exact = pow(SLIT_WIDTH, 3) / 12.0 / 7.0;
  for (double shift = 0.0; shift < 1.0; shift += 0.23) {
    const double k = permeability(size, 1.0, slit_shifted, shift, WALL_SUBVOXEL);
    assert_true(fabs(k / exact - 1.0) < 0.04);
  }
}

static void test_walls_are_ordered_by_accuracy(void **state) {
  (void)state;
  const size_t size[3] = {7, 1, 1};
  const double exact = pow(SLIT_WIDTH, 3) / 12.0 / 7.0;
  const double frozen = permeability(size, 1.0, slit_shifted, 0.0, WALL_FROZEN) / exact;
  assert_true(fabs(frozen - 1.934) < 0.01); /* exact lattice theory of the slit: +93.4 % */
}

/* A pore closed along z carries nothing, whatever leads around in x. */
static double channel_along_x(const double at[3], double unused) {
  (void)unused;
  return at[2] > 3.0 && at[2] < 5.0 ? fmin(at[2] - 3.0, 5.0 - at[2]) : -1.0;
}

static void test_blocked_pores_are_left_out(void **state) {
  (void)state;
  struct lattice lattice;
  struct stokes_solver solver;
  const size_t size[3] = {4, 4, 8};
  const double along[3] = {1.0, 0.0, 0.0}, across[3] = {0.0, 0.0, 1.0};
  lattice_fill(&lattice, size, 1.0, channel_along_x, 0.0);
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9, WALL_SUBVOXEL, 1.0, across, &solver),
                   STATUS_OK);
  assert_int_equal(solver.grid.active, 0);
  stokes_solver_free(&solver);
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9, WALL_SUBVOXEL, 1.0, along, &solver),
                   STATUS_OK);
  assert_int_equal(solver.grid.active, 4 * 4 * 2);
  stokes_solver_free(&solver);
  lattice_empty(&lattice);
}

static double no_wall(const double at[3], double unused) {
  (void)at, (void)unused;
  return 1.0;
}

static void test_no_wall_is_an_input_error(void **state) {
  (void)state;
  struct lattice lattice;
  struct stokes_solver solver;
  const size_t size[3] = {4, 4, 4};
  const double driving[3] = {0.0, 0.0, 1.0}, none[3] = {0.0};
  lattice_fill(&lattice, size, 1.0, no_wall, 0.0);
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9, WALL_SUBVOXEL, 1.0, driving, &solver),
                   STATUS_INPUT);
  assert_non_null(strstr(error_message(), "no wall"));
  error_clear();
  assert_int_equal(stokes_solver_build(&lattice, NULL, 2.9, WALL_SUBVOXEL, 1.0, none, &solver),
                   STATUS_INPUT);
  error_clear();
  lattice_empty(&lattice);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_spheres_within_one_per_cent),
      cmocka_unit_test(test_slit_at_any_shift),
      cmocka_unit_test(test_walls_are_ordered_by_accuracy),
      cmocka_unit_test(test_blocked_pores_are_left_out),
      cmocka_unit_test(test_no_wall_is_an_input_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
