/* Walls thinner than the spacing, on lattices of any spacing and position. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "common/memory.h"
#include "sphsolve/geometry/thin_wall.h"
#include "sphsolve/geometry/percolation.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/geometry/throat_width.h"
#include "sphsolve/geometry/wall_shape.h"
#include "sphsolve/stokes/solver/state.h"
#include "sphsolve/stokes/solver/step.h"

#define N 48
static const double along_z[3] = {0.0, 0.0, -1.0};

/* A periodic body of unit voxels whose wall distance at x is given by `distance`. */
static void make_body(double (*distance)(const double x[3]), struct lattice *l) {
  *l = (struct lattice){.dimensions = 3, .size = {N, N, N}, .spacing = {1.0, 1.0, 1.0}};
  l->count = N * N * N;
  l->bulk_count = (double)l->count;
  assert_int_equal(memory_allocate(&l->kind, l->count, 1, "test"), STATUS_OK);
  assert_int_equal(memory_allocate(&l->wall_distance, l->count, sizeof(float), "test"), STATUS_OK);
  for (size_t s = 0; s < l->count; s++) {
    l->origin[0] = l->origin[1] = l->origin[2] = 0.5;
    const double x[3] = {(double)(s % N) + 0.5, (double)(s / N % N) + 0.5,
                         (double)(s / N / N) + 0.5};
    l->wall_distance[s] = (float)distance(x);
  }
  lattice_set_kinds(l, 0.0F, 1e-3F);
}

static double membrane_place, ball_radius;

/* A membrane one voxel thick across z, and walls at the sides of the box in x. */
static double membrane(const double x[3]) {
  double z = fabs(x[2] - membrane_place);
  z = fmin(z, N - z);
  return fmin(z - 0.5, fmin(x[0], N - x[0]) - 4.0);
}

/* The same with a round hole of radius 6 voxels in its middle; the rim is exact outside corners. */
static double pierced(const double x[3]) {
  double z = fabs(x[2] - membrane_place);
  z = fmin(z, N - z) - 0.5;
  const double rim = 6.0 - hypot(x[0] - 0.5 * N, x[1] - 0.5 * N);
  const double wall = rim <= 0.0 ? z : z <= 0.0 ? rim : hypot(z, rim);
  return fmin(wall, fmin(x[0], N - x[0]) - 4.0);
}

static double ball(const double x[3]) {
  double square = 0.0;
  for (int a = 0; a < 3; a++) square += (x[a] - 0.5 * N) * (x[a] - 0.5 * N);
  return sqrt(square) - ball_radius;
}

static void test_membrane_separates_on_any_lattice(void **state) {
  (void)state;
  for (int place = 0; place < 6; place++) {
    struct lattice fine;
    membrane_place = 20.0 + 0.7 * place;
    make_body(membrane, &fine);
    for (double spacing = 1.0; spacing < 9.0; spacing *= 1.4142) {
      struct lattice coarse;
      bool flows;
      assert_int_equal(lattice_resample(&fine, spacing, 0.0, &coarse), STATUS_OK);
      assert_int_equal(percolation_find(&coarse, along_z, false, NULL, &flows), STATUS_OK);
      assert_false(flows);
      lattice_free(&coarse);
    }
    lattice_free(&fine);
  }
}

/* Both ends of every link of the stencil agree, and a face of the wall lies between them. */
static void test_both_ends_of_a_link_agree(void **state) {
  (void)state;
  struct lattice fine, coarse;
  size_t cuts = 0;
  membrane_place = 21.3;
  make_body(pierced, &fine);
  assert_int_equal(lattice_resample(&fine, 4.0, 0.0, &coarse), STATUS_OK);
  for (size_t s = 0; s < coarse.count; s++) {
    const size_t *n = coarse.size, at[3] = {s % n[0], s / n[0] % n[1], s / n[0] / n[1]};
    if (coarse.kind[s] != SITE_FLUID) continue;
    for (int o = 0; o < 27; o++) {
      const int step[3] = {o % 3 - 1, o / 3 % 3 - 1, o / 9 - 1};
      const int back[3] = {-step[0], -step[1], -step[2]};
      size_t to[3];
      for (int a = 0; a < 3; a++) to[a] = (size_t)((long)(at[a] + n[a]) + step[a]) % n[a];
      const size_t other = (to[2] * n[1] + to[1]) * n[0] + to[0];
      struct thin_wall_side near, far, near_back, far_back;
      if (o == 13 || coarse.kind[other] != SITE_FLUID) continue;
      const bool cut = thin_wall_cuts(&coarse, at, step, &near, &far);
      assert_int_equal(cut, thin_wall_cuts(&coarse, to, back, &near_back, &far_back));
      if (!cut) continue;
      cuts++;
      assert_true(near.before == far_back.before && far.behind == near_back.behind);
      assert_true(near.before >= 0.0 && far.before >= 0.0);
    }
  }
  assert_true(cuts > 100);
  lattice_free(&coarse);
  lattice_free(&fine);
}

/* A link that only cuts off a piece of a large ball stays open: the fluid goes around. */
static void test_large_grains_cut_nothing(void **state) {
  (void)state;
  struct lattice fine, coarse;
  ball_radius = 18.0;
  make_body(ball, &fine);
  assert_int_equal(lattice_resample(&fine, 4.0, 0.0, &coarse), STATUS_OK);
  assert_null(coarse.cut);
  for (size_t s = 0; s < coarse.count; s++) {
    const size_t *n = coarse.size, at[3] = {s % n[0], s / n[0] % n[1], s / n[0] / n[1]};
    if (coarse.kind[s] != SITE_FLUID) continue;
    const int step[3] = {1, 1, 0};
    const size_t other = (at[2] * n[1] + (at[1] + 1) % n[1]) * n[0] + (at[0] + 1) % n[0];
    if (coarse.kind[other] == SITE_FLUID)
      assert_false(thin_wall_cuts(&coarse, at, step, NULL, NULL));
  }
  lattice_free(&coarse);
  lattice_free(&fine);
}

static void test_critical_width_is_that_of_the_hole(void **state) {
  (void)state;
  struct lattice fine;
  double width;
  membrane_place = 21.5;
  make_body(pierced, &fine);
  assert_int_equal(throat_width_find(&fine, along_z, &width), STATUS_OK);
  assert_true(width > 10.2 && width < 12.1);
  lattice_free(&fine);
  make_body(membrane, &fine);
  assert_int_equal(throat_width_find(&fine, along_z, &width), STATUS_OK);
  assert_true(width == 0.0);
  lattice_free(&fine);
}

/* Where all sites are d from the walls it is 2 d, less a twentieth at most of itself or a spacing.
 */
static void test_critical_width_of_one_distance(void **state) {
  (void)state;
  uint8_t kind[64];
  float distance[64];
  const struct lattice l = {.dimensions = 3,
                            .size = {4, 4, 4},
                            .count = 64,
                            .spacing = {1.0, 1.0, 1.0},
                            .kind = kind,
                            .wall_distance = distance};
  for (double d = 0.3; d < 20.0; d *= 1.13) {
    double width;
    for (size_t s = 0; s < 64; s++) kind[s] = SITE_FLUID, distance[s] = (float)d;
    assert_int_equal(throat_width_find(&l, along_z, &width), STATUS_OK);
    assert_true(width < 2.0 * d + 1e-6 && 2.0 * d - width < 0.05 * fmax(width, 1.0) + 1e-6);
  }
}

/* A round hole in a thin wall passes Q = c^3 dp / (3 mu) (Sampson 1891). With k = 1 / (N dp) for
 * force 1 along z the drop over the plate is N less what the channel beside it takes, some 7 %
 * here; without the wall k would be 40 times as large. */
static void test_hole_in_a_membrane_lets_through_what_sampson_says(void **state) {
  (void)state;
  struct lattice fine;
  membrane_place = 21.3;
  make_body(pierced, &fine);
  const double sampson = 6.0 * 6.0 * 6.0 / (3.0 * N);
  for (double spacing = 3.0; spacing < 4.5; spacing += 1.0) {
    struct lattice coarse;
    struct stokes_solver s;
    const struct stokes_goal goal = {.mean = 1e-3};
    assert_int_equal(lattice_resample(&fine, spacing, 0.0, &coarse), STATUS_OK);
    assert_non_null(coarse.cut);
    assert_int_equal(
        stokes_solver_build(&coarse, NULL, 2.9 * spacing, WALL_SUBVOXEL, 1.0, along_z, &s),
        STATUS_OK);
    assert_int_equal(stokes_solver_run(&s, &goal), STATUS_OK);
    const double k = fabs(s.mean[2]) * spacing * spacing;
    assert_true(k > 0.6 * sampson && k < 1.6 * sampson);
    stokes_solver_free(&s);
    lattice_free(&coarse);
  }
  lattice_free(&fine);
}

/* Tube along z. */
static double tube(const double x[3]) {
  return ball_radius - hypot(x[0] - 0.5 * N, x[1] - 0.5 * N);
}

/* A ball has 1 / R at any distance from it, a half plane's edge more than a spacing can resolve, a
 * tube, hollow seen from the water, none. */
static void test_curvature_is_that_of_the_nearest_wall(void **state) {
  (void)state;
  const float exact = 1.0F / 12.0F;
  struct lattice l, coarse;
  ball_radius = 12.0;
  make_body(ball, &l);
  for (size_t i = 38; i < 46; i++) { /* 2.5 to 9.5 voxels from the ball */
    assert_float_equal(wall_curvature(&l, (size_t[3]){i, N / 2, N / 2}), exact, 0.004F);
    assert_float_equal(wall_curvature(&l, (size_t[3]){i, 29, 16}), exact, 0.004F);
  }
  lattice_free(&l);
  membrane_place = 21.5;
  make_body(pierced, &l);
  assert_int_equal(lattice_resample(&l, 3.0, 0.0, &coarse), STATUS_OK);
  for (size_t i = 6; i < 10; i++) /* in the hole */
    assert_true(wall_curvature(&coarse, (size_t[3]){i, 8, 7}) > 1.0 / 3.0);
  lattice_free(&coarse);
  lattice_free(&l);
  ball_radius = 10.0;
  make_body(tube, &l);
  for (size_t i = 16; i < 32; i++)
    assert_float_equal(wall_curvature(&l, (size_t[3]){i, N / 2, 7}), 0.0F, 1e-4F);
  lattice_free(&l);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_membrane_separates_on_any_lattice),
      cmocka_unit_test(test_both_ends_of_a_link_agree),
      cmocka_unit_test(test_large_grains_cut_nothing),
      cmocka_unit_test(test_critical_width_is_that_of_the_hole),
      cmocka_unit_test(test_critical_width_of_one_distance),
      cmocka_unit_test(test_curvature_is_that_of_the_nearest_wall),
      cmocka_unit_test(test_hole_in_a_membrane_lets_through_what_sampson_says),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
