/* Physics of wcsph on flows whose answers are known. */
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "sphsolve/stokes/solver/step.h"
#include "sphsolve/geometry/percolation.h"
#include "tests/unit/engine_march.h"

/* Limits found with a prototype: c dt/dx < 1.014 absolute, 2.19 (c dt/h 2.2) gauge, viscous
 * eigenvalue 4.30 nu/dx^2. */
static void test_eigenvalues(void **state) {
  (void)state;
  double spacing[3] = {1, 1, 1};
  struct lattice_modes modes = lattice_modes_find(KERNEL_QUINTIC, 3, spacing, 2.9 / 3);
  assert_true(fabs(2 / modes.absolute - 1.014) < 0.02);
  assert_true(fabs(2 / modes.gradient - 2.19) < 0.06);
  assert_true(fabs(modes.laplacian - 4.30) < 0.05);
  assert_true(fabs(modes.sum - 1) < 0.005);
}

/* Sub-voxel walls: particles that move, and that stay. */
static const enum pass_wall subvoxel[2] = {PASS_SUBVOXEL, PASS_EULERIAN};
static const char *const subvoxel_name[2] = {"moving", "Eulerian"};

/* A cylinder of radius p0 in the middle of a box of p1. */
static double test_cylinder(const double at[3], const double p[4]) {
  return hypot(at[0] - p[1] / 2, at[2] - p[1] / 2) - p[0];
}

/* Error of the flow rate of a slit after the start-up has died. */
static double slit_error_of(enum kernel kernel, enum pass_wall wall, size_t width, double phase) {
  double dx = 1e-4, nu = 1e-6, f = 1e-3, w = (double)width * dx;
  struct lattice lattice = test_slit(width, phase, dx);
  double wide = w + (wall == PASS_FROZEN ? dx : 0);
  struct march march = {
      .kernel = kernel, .wall = wall, .nu = nu, .force = {f}, .end = 1.1 * wide * wide / nu};
  double darcy = test_march(&lattice, &march, NULL);
  double exact = f * w * w * w / (12 * nu) / ((double)lattice.size[2] * dx);
  test_lattice_free(&lattice);
  return darcy / exact - 1;
}

static double slit_error(enum pass_wall wall, size_t width, double phase) {
  return slit_error_of(KERNEL_QUINTIC, wall, width, phase);
}

static void test_slit_frozen(void **state) {
  (void)state;
  double e4 = slit_error(PASS_FROZEN, 4, 0.5), e8 = slit_error(PASS_FROZEN, 8, 0.5);
  print_message("frozen slit: w = 4 %+.1f %%, w = 8 %+.1f %%\n", 100 * e4, 100 * e8);
  assert_true(fabs(e4 - 0.934) < 0.03);
  assert_true(fabs(e8 - 0.430) < 0.02);
}

static void test_slit_adami(void **state) {
  (void)state;
  double e4 = slit_error(PASS_ADAMI, 4, 0.5), e8 = slit_error(PASS_ADAMI, 8, 0.5);
  print_message("adami slit: w = 4 %+.1f %%, w = 8 %+.1f %%\n", 100 * e4, 100 * e8);
  assert_true(fabs(e4 - 0.147) < 0.03);
  assert_true(fabs(e8 - 0.037) < 0.01);
}

static void test_slit_subvoxel(void **state) {
  (void)state;
  const size_t widths[] = {2, 4, 8, 16};
  for (int i = 0; i < 8; i++) {
    double error = slit_error(subvoxel[i / 4], widths[i % 4], 0.5);
    print_message("subvoxel slit, %s: w = %zu %+.4f %%\n", subvoxel_name[i / 4], widths[i % 4],
                  100 * error);
    assert_true(fabs(error) < 1e-3); /* exact, but for what is left of the start-up */
  }
}

static void test_slit_subvoxel_shifted(void **state) {
  (void)state;
  for (int i = 1; i < 16; i += 2) {
    double error = slit_error(subvoxel[i / 8], 8, i % 8 / 8.0);
    print_message("subvoxel slit, %s, w = 8, surface at %.3f: %+.2f %%\n", subvoxel_name[i / 8],
                  i % 8 / 8.0, 100 * error);
    assert_true(fabs(error) < 1e-3);
  }
}

/* Turned by atan(4/7) = 29.7 degrees, the nearest that repeats in a small box. */
/* As with the quintic spline; of 16 rows that shear past each other .16 % where that has .10. */
static void test_slit_wendland(void **state) {
  (void)state;
  const size_t widths[] = {2, 4, 8, 16};
  for (int i = 0; i < 8; i++) {
    double error = slit_error_of(KERNEL_WENDLAND, subvoxel[i / 4], widths[i % 4], 0.5);
    print_message("subvoxel slit, Wendland, %s: w = %zu %+.4f %%\n", subvoxel_name[i / 4],
                  widths[i % 4], 100 * error);
    assert_true(fabs(error) <
                (subvoxel[i / 4] == PASS_SUBVOXEL && widths[i % 4] == 16 ? 2e-3 : 1e-3));
  }
  const double adami = slit_error_of(KERNEL_WENDLAND, PASS_ADAMI, 8, 0.5);
  const double frozen = slit_error_of(KERNEL_WENDLAND, PASS_FROZEN, 8, 0.5);
  print_message("slit, Wendland, w = 8: adami %+.2f %%, frozen %+.2f %%\n", 100 * adami,
                100 * frozen);
  assert_true(fabs(adami - 0.049) < 0.01);
  assert_true(fabs(frozen - 0.503) < 0.02);
}

static void test_slit_subvoxel_turned(void **state) {
  (void)state;
  double length = hypot(7, 4), dx = 1e-4, nu = 1e-6, f = 1e-3, w = 8;
  double parameter[4] = {w, 97 / length, 7 / length, 4 / length};
  struct lattice lattice =
      test_geometry(2, (const size_t[3]){97, 1, 97}, dx, test_turned_slit, parameter);
  struct march march = {
      .nu = nu, .force = {-f * 4 / length, 0, f * 7 / length}, .end = 1.1 * w * w * dx * dx / nu};
  for (int i = 0; i < 2; i++) {
    march.wall = subvoxel[i];
    double error =
        test_march(&lattice, &march, NULL) / (f * w * w * w * dx * dx / (12 * nu) / parameter[1]) -
        1;
    print_message("subvoxel slit, %s, w = 8, turned by 30 degrees: %+.2f %%\n", subvoxel_name[i],
                  100 * error);
    assert_true(fabs(error) < 0.03);
  }
  test_lattice_free(&lattice);
}

/* In pores two to three particles wide, creeping, particles moving: k depends neither on the sound
 * speed nor on how fast, and so how far, the particles move through the grains. */
static void test_pinning(void **state) {
  (void)state;
  double dx = 5e-5, nu = 1e-5, g = 100;
  const double parameter[4] = {18, 4.5, 14, 7};
  struct lattice lattice =
      test_geometry(3, (const size_t[3]){18, 18, 18}, dx, test_balls, parameter);
  struct march march = {
      .wall = PASS_SUBVOXEL, .nu = nu, .force = {0, 0, -g}, .end = 0.02, .sound = 1.2};
  double travel, k = test_march(&lattice, &march, &travel) / g;
  march.sound *= 2;
  double k_sound = test_march(&lattice, &march, NULL) / g;
  march.sound /= 2;
  march.force[2] /= 10;
  double k_slow = test_march(&lattice, &march, NULL) / (g / 10);
  print_message("balls, pores %.1f wide: moved by %.2f spacings; sound speed doubled %+.2f %%, "
                "a tenth of the force %+.2f %%\n",
                wcsph_gap(&lattice), travel, 100 * (k_sound / k - 1), 100 * (k_slow / k - 1));
  test_lattice_free(&lattice);
  assert_true(travel > 0.5);
  assert_true(fabs(k_sound / k - 1) < 0.03);
  assert_true(fabs(k_slow / k - 1) < 0.03);
}

/* On sites the march ends where method stokes is at once, in pores two sites wide as in wide ones,
 * whatever the force while the flow creeps. */
static void test_stokes_eulerian(void **state) {
  (void)state;
  const double dx = 5e-5, nu = 1e-5, g = 100, parameter[2][4] = {{16, 3.3, 24, 7}, {16, 5, 4, 3}};
  for (int i = 0; i < 2; i++) {
    struct lattice lattice =
        test_geometry(3, (const size_t[3]){16, 16, 16}, dx, test_balls, parameter[i]);
    struct march march = {
        .wall = PASS_EULERIAN, .nu = nu, .force = {0, 0, -g}, .end = 0.02, .sound = 1.2};
    struct stokes_solver solver;
    bool flows;
    size_t closed;
    assert_int_equal(
        stokes_solver_build(&lattice, NULL, 2.9 * dx, WALL_SUBVOXEL, nu, march.force, &solver),
        STATUS_OK);
    assert_int_equal(stokes_solver_run(&solver, &(struct stokes_goal){.residual = 1e-6}),
                     STATUS_OK);
    const double exact = -solver.mean[2] * solver.velocity_unit / g;
    stokes_solver_free(&solver);
    assert_int_equal(percolation_close(&lattice, march.force, &closed, &flows), STATUS_OK);
    const double k = test_march(&lattice, &march, NULL) / g;
    march.force[2] /= 10;
    const double k_slow = test_march(&lattice, &march, NULL) / (g / 10);
    print_message("balls, pores %.1f wide, Eulerian: %+.2f %% of stokes; a tenth of the force "
                  "%+.3f %%\n",
                  wcsph_gap(&lattice), 100 * (k / exact - 1), 100 * (k_slow / k - 1));
    test_lattice_free(&lattice);
    assert_true(fabs(k / exact - 1) < 0.01);
    assert_true(fabs(k_slow / k - 1) < 0.01);
  }
}

/* k, nu/g: of a square array of cylinders, share .2, n sites a side of 3.2 mm. */
static double inertial_array(enum pass_wall wall, size_t n, double force) {
  const double side = (double)n;
  struct lattice lattice =
      test_geometry(2, (const size_t[3]){n, 1, n}, 3.2e-3 / side, test_cylinder,
                    (const double[4]){sqrt(0.2 / M_PI) * side, side});
  struct march march = {
      .wall = wall, .nu = 1e-6, .force = {force}, .end = 3, .sound = force < 0.01 ? 0.02 : 0.1};
  const double u = test_march(&lattice, &march, NULL);
  test_lattice_free(&lattice);
  return u / force;
}

/* Inertia of Eulerian particles: at Re 6 as with moving particles; at Re 17, where it takes a ninth
 * of the flow, the same on twice as fine a lattice. */
static void test_inertia_eulerian(void **state) {
  (void)state;
  const double slow = inertial_array(PASS_EULERIAN, 32, 0.0006);
  const double moving = inertial_array(PASS_SUBVOXEL, 32, 0.02);
  const double sites = inertial_array(PASS_EULERIAN, 32, 0.02);
  const double coarse = inertial_array(PASS_EULERIAN, 16, 0.06);
  const double fine = inertial_array(PASS_EULERIAN, 32, 0.06);
  print_message("cylinders, Re 6: inertia takes %.2f %%, moving %+.2f %% of on sites; Re 17: takes "
                "%.2f %%, 16 a side %+.2f %% of 32\n",
                100 * (1 - sites / slow), 100 * (moving / sites - 1), 100 * (1 - fine / slow),
                100 * (coarse / fine - 1));
  assert_true(fabs(moving / sites - 1) < 0.01);
  assert_true(fine / slow < 0.92);
  assert_true(fabs(coarse / fine - 1) < 0.01);
}

static void test_percolation(void **state) {
  (void)state;
  struct lattice slit = test_slit(4, 0.5, 1);
  bool flows;
  const double along[3] = {1, 0, 0}, across[3] = {0, 0, -1};
  assert_int_equal(percolation_find(&slit, along, true, NULL, &flows), STATUS_OK);
  assert_true(flows);
  assert_int_equal(percolation_find(&slit, across, true, NULL, &flows), STATUS_OK);
  assert_false(flows);
  test_lattice_free(&slit);
}

int main(void) {
  omp_set_num_threads(1);
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_eigenvalues),
      cmocka_unit_test(test_slit_frozen),
      cmocka_unit_test(test_slit_adami),
      cmocka_unit_test(test_slit_subvoxel),
      cmocka_unit_test(test_slit_subvoxel_shifted),
      cmocka_unit_test(test_slit_wendland),
      cmocka_unit_test(test_slit_subvoxel_turned),
      cmocka_unit_test(test_pinning),
      cmocka_unit_test(test_stokes_eulerian),
      cmocka_unit_test(test_inertia_eulerian),
      cmocka_unit_test(test_percolation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
