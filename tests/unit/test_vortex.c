/* Taylor-Green vortices: no walls, shifted particles, decay known. */
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <cmocka.h>

#include "tests/unit/engine_lattice.h"

/* Kinetic energy at t = end over the exact exp(-16 pi^2 t/Re) of a unit box with U = 1. */
static double energy_ratio(size_t n, double reynolds, double end) {
  double dx = 1.0 / (double)n, nu = 1 / reynolds;
  struct lattice lattice = test_lattice(2, n, 1, n, dx, dx, dx);
  struct engine_settings settings = test_settings(&lattice, PASS_OPEN, 2.9 * dx);
  struct lattice_modes modes = lattice_modes_find(2, lattice.spacing, settings.smoothing_length);
  settings.kinematic_viscosity = nu;
  settings.sound_speed = 10;
  settings.dt = 0.6 * 2 / (settings.sound_speed * modes.gradient);
  settings.pressure_diffusion = 0.1 * settings.smoothing_length * settings.sound_speed;
  struct engine engine;
  assert_int_equal(engine_make(&lattice, &settings, &engine), STATUS_OK);
  struct particles *p = &engine.particles;
  double start = 0, energy = 0;
  for (size_t i = 0; i < particles_slots(p); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    double at[3];
    particles_position(p, &lattice, i, at);
    double x = 2 * M_PI * (at[0] + dx / 2), z = 2 * M_PI * (at[2] + dx / 2);
    p->v[0][i] = (float)(-cos(x) * sin(z));
    p->v[2][i] = (float)(sin(x) * cos(z));
    /* The pressure that goes with it, or sound would ring. */
    p->state[i] = (float)(-0.25 * (cos(2 * x) + cos(2 * z)) / 100);
    start += (double)(p->v[0][i] * p->v[0][i] + p->v[2][i] * p->v[2][i]);
  }
  engine.speed_max = 1;
  int steps = (int)ceil(end / settings.dt);
  for (int s = 0; s < steps; s++) assert_int_equal(engine_step(&engine), STATUS_OK);
  for (size_t i = 0; i < particles_slots(p); i++)
    if (p->id[i] != NO_PARTICLE)
      energy += (double)(p->v[0][i] * p->v[0][i] + p->v[2][i] * p->v[2][i]);
  double exact = exp(-16 * M_PI * M_PI * nu * steps * settings.dt);
  engine_free(&engine);
  test_lattice_free(&lattice);
  return energy / start / exact;
}

static void test_decay(void **state) {
  (void)state;
  double coarse = energy_ratio(25, 100, 0.5), fine = energy_ratio(50, 100, 0.5);
  print_message("Taylor-Green, Re 100, t = 0.5: energy %.4f (25), %.4f (50) of the exact\n", coarse,
                fine);
  assert_true(fabs(fine - 1) < 0.02);
  assert_true(fabs(fine - 1) < fabs(coarse - 1));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_decay)};
  omp_set_num_threads(1);
  return cmocka_run_group_tests(tests, NULL, NULL);
}
