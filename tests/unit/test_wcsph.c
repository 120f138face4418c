/* Physics of wcsph on flows whose answers are known. */
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "sphsolve/percolation.h"
#include "tests/unit/engine_lattice.h"

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
  double dx = 1e-4, nu = 1e-6, f = 1e-3, h = 2.9 * dx / 3;
  struct lattice lattice = test_slit(width, phase, dx);
  struct engine_settings settings = test_settings(&lattice, wall, 2.9 * dx);
  double w = (double)width * dx;
  struct lattice_modes modes = lattice_modes_find(2, lattice.spacing, h);
  settings.kinematic_viscosity = nu;
  settings.sound_speed = 2 * nu / h;
  double viscous = 2 / (nu * modes.laplacian), sound = 2 / (settings.sound_speed * modes.gradient);
  double q = sound / viscous;
  settings.dt = 0.8 * sound * (sqrt(q * q / 4 + 1) - q / 2);
  settings.force[0] = f;
  settings.pressure_diffusion = 0.005 * dx * dx / nu * settings.sound_speed * settings.sound_speed;
  struct engine engine;
  assert_int_equal(engine_make(&lattice, &settings, &engine), STATUS_OK);
  double wide = w + (wall == PASS_FROZEN ? dx : 0);
  int steps = (int)(1.1 * wide * wide / nu / settings.dt) + 10;
  for (int s = 0; s < steps; s++) assert_int_equal(engine_step(&engine), STATUS_OK);
  double sum = 0;
  const struct particles *p = &engine.particles;
  for (size_t i = 0; i < particles_slots(p); i++)
    if (p->id[i] != NO_PARTICLE) sum += (double)p->v[0][i];
  double flow = sum / 6 * dx, exact = f * w * w * w / (12 * nu);
  engine_free(&engine);
  test_lattice_free(&lattice);
  return flow / exact - 1;
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
  const double bounds[] = {0.13, 0.04, 0.01, 0.003};
  double error[4];
  for (int i = 0; i < 4; i++) {
    error[i] = slit_error(PASS_SUBVOXEL, widths[i], 0.5);
    print_message("subvoxel slit: w = %zu %+.2f %%\n", widths[i], 100 * error[i]);
    assert_true(fabs(error[i]) < bounds[i]);
  }
  assert_true(fabs(error[1]) / fabs(error[3]) > 10); /* order 2: 16 for a factor 4 */
}

static void test_slit_subvoxel_shifted(void **state) {
  (void)state;
  for (int i = 1; i < 8; i += 2) {
    double error = slit_error(PASS_SUBVOXEL, 8, i / 8.0);
    print_message("subvoxel slit, w = 8, surface at %.3f: %+.2f %%\n", i / 8.0, 100 * error);
    assert_true(fabs(error) < 0.03);
  }
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
      cmocka_unit_test(test_percolation),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
