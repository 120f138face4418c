/* Physics of wcsph on flows whose answers are known. */
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "sphsolve/percolation.h"
#include "tests/unit/engine_march.h"

/* Limits found with a prototype: c dt/dx < 1.014 absolute, 2.19 (c dt/h 2.2) gauge, viscous
 * eigenvalue 4.30 nu/dx^2. */
static void test_eigenvalues(void **state) {
  (void)state;
  double spacing[3] = {1, 1, 1};
  struct lattice_modes modes = lattice_modes_find(3, spacing, 2.9 / 3);
  assert_true(fabs(2 / modes.absolute - 1.014) < 0.02);
  assert_true(fabs(2 / modes.gradient - 2.19) < 0.06);
  assert_true(fabs(modes.laplacian - 4.30) < 0.05);
  assert_true(fabs(modes.sum - 1) < 0.005);
}

/* Error of the flow rate of a slit after the start-up has died, particles moving. */
static double slit_error(enum pass_wall wall, size_t width, double phase) {
  double dx = 1e-4, nu = 1e-6, f = 1e-3, w = (double)width * dx;
  struct lattice lattice = test_slit(width, phase, dx);
  double wide = w + (wall == PASS_FROZEN ? dx : 0);
  struct march march = {.wall = wall, .nu = nu, .force = {f}, .end = 1.1 * wide * wide / nu};
  double darcy = test_march(&lattice, &march, NULL);
  double exact = f * w * w * w / (12 * nu) / ((double)lattice.size[2] * dx);
  test_lattice_free(&lattice);
  return darcy / exact - 1;
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
  for (int i = 0; i < 4; i++) {
    double error = slit_error(PASS_SUBVOXEL, widths[i], 0.5);
    print_message("subvoxel slit: w = %zu %+.4f %%\n", widths[i], 100 * error);
    assert_true(fabs(error) < 1e-3); /* exact, but for what is left of the start-up */
  }
}

static void test_slit_subvoxel_shifted(void **state) {
  (void)state;
  for (int i = 1; i < 8; i += 2) {
    double error = slit_error(PASS_SUBVOXEL, 8, i / 8.0);
    print_message("subvoxel slit, w = 8, surface at %.3f: %+.2f %%\n", i / 8.0, 100 * error);
    assert_true(fabs(error) < 1e-3);
  }
}

/* Turned by atan(4/7) = 29.7 degrees, the nearest that repeats in a small box. */
static void test_slit_subvoxel_turned(void **state) {
  (void)state;
  double length = hypot(7, 4), dx = 1e-4, nu = 1e-6, f = 1e-3, w = 8;
  double parameter[4] = {w, 97 / length, 7 / length, 4 / length};
  struct lattice lattice =
      test_geometry(2, (const size_t[3]){97, 1, 97}, dx, test_turned_slit, parameter);
  struct march march = {.wall = PASS_SUBVOXEL,
                        .nu = nu,
                        .force = {-f * 4 / length, 0, f * 7 / length},
                        .end = 1.1 * w * w * dx * dx / nu};
  double error =
      test_march(&lattice, &march, NULL) / (f * w * w * w * dx * dx / (12 * nu) / parameter[1]) - 1;
  test_lattice_free(&lattice);
  print_message("subvoxel slit, w = 8, turned by 30 degrees: %+.2f %%\n", 100 * error);
  assert_true(fabs(error) < 0.03);
}

/* In pores two to three particles wide, creeping: k depends neither on the sound speed nor on how
 * fast, and so how far, the particles move through the grains. */
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

static void test_percolation(void **state) {
  (void)state;
  struct lattice slit = test_slit(4, 0.5, 1);
  bool flows;
  const double along[3] = {1, 0, 0}, across[3] = {0, 0, -1};
  assert_int_equal(percolation_find(&slit, along, &flows), STATUS_OK);
  assert_true(flows);
  assert_int_equal(percolation_find(&slit, across, &flows), STATUS_OK);
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
      cmocka_unit_test(test_slit_subvoxel_turned),
      cmocka_unit_test(test_pinning),
      cmocka_unit_test(test_percolation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
