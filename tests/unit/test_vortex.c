/* Taylor-Green vortices: no walls, shifted particles, decay known. */
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "tests/unit/engine_vortex.h"

/* Kinetic energy at t = end over the exact exp(-16 pi^2 t/Re) of a unit box with U = 1; `error`:
 * rms of the velocities' error over their rms. The step is the automatic one. */
static double energy_ratio(size_t n, double reynolds, double end, double *error) {
  const double dx = 1.0 / (double)n;
  struct lattice lattice;
  struct engine engine;
  assert_int_equal(test_vortex_make(n, reynolds, &lattice, &engine), STATUS_OK);
  const struct particles *p = &engine.particles;
  const double start = test_vortex_energy(&engine, NULL), dt = engine.settings.dt;
  int steps = (int)ceil(end / dt);
  for (int s = 0; s < steps; s++) assert_int_equal(engine_step(&engine), STATUS_OK);
  double exact = exp(-16 * M_PI * M_PI / reynolds * steps * dt), wrong = 0;
  for (size_t i = 0; i < particles_slots(p); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    double at[3], vx = (double)p->v[0][i], vz = (double)p->v[2][i];
    particles_position(p, &lattice, i, at);
    double x = 2 * M_PI * (at[0] + dx / 2), z = 2 * M_PI * (at[2] + dx / 2);
    wrong +=
        pow(vx + sqrt(exact) * cos(x) * sin(z), 2) + pow(vz - sqrt(exact) * sin(x) * cos(z), 2);
  }
  *error = sqrt(wrong / (start * exact));
  const double energy = test_vortex_energy(&engine, NULL);
  engine_free(&engine);
  test_lattice_free(&lattice);
  return energy / start / exact;
}

static void test_decay(void **state) {
  (void)state;
  double error[4];
  double coarse = energy_ratio(25, 100, 0.5, &error[0]),
         fine = energy_ratio(50, 100, 0.5, &error[1]);
  energy_ratio(25, 1000, 0.5, &error[2]);
  double fast = energy_ratio(50, 1000, 0.5, &error[3]);
  print_message("Taylor-Green, t = 0.5, Re 100: energy %.4f (25), %.4f (50) of the exact, Re 1000: "
                "%.4f (50); velocities off by %.2g, %.2g and %.2g, %.2g\n",
                coarse, fine, fast, error[0], error[1], error[2], error[3]);
  assert_true(fabs(fine - 1) < 0.01);
  assert_true(fabs(fast - 1) < 0.01);
  assert_true(error[1] < 0.6 * error[0]);
  assert_true(error[3] < 0.5 * error[2]);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_decay)};
  omp_set_num_threads(1);
  return cmocka_run_group_tests(tests, NULL, NULL);
}
