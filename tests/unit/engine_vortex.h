/* Taylor-Green vortices (Taylor, Green 1937) for the tests of the engine: a unit box, U = 1, whose
 * kinetic energy falls as exp(-16 pi^2 t/Re). */
#ifndef TOSUI_TESTS_UNIT_ENGINE_VORTEX_H
#define TOSUI_TESTS_UNIT_ENGINE_VORTEX_H

#include "sphsolve/wcsph/effects/shifting.h"
#include "tests/unit/engine_lattice.h"

/* n x n particles, with the step that a plan would choose. */
static inline enum status test_vortex_make(size_t n, double reynolds, struct lattice *lattice,
                                           struct engine *engine) {
  const double dx = 1.0 / (double)n;
  *lattice = test_lattice(2, n, 1, n, dx, dx, dx);
  struct engine_settings settings = test_settings(lattice, PASS_OPEN, 2.9 * dx);
  const struct lattice_modes modes =
      lattice_modes_find(KERNEL_QUINTIC, 2, lattice->spacing, settings.smoothing_length);
  settings.kinematic_viscosity = 1 / reynolds;
  settings.sound_speed = 10;
  settings.dt = fmin(0.6 * 2 / (settings.sound_speed * modes.gradient),
                     SHIFTING_STABLE / (SHIFTING_STRENGTH_LEAST * settings.smoothing_length *
                                        modes.shifting_stiffness));
  settings.pressure_diffusion = 0.1 * settings.smoothing_length * settings.sound_speed;
  const enum status status = engine_make(lattice, &settings, engine);
  if (status != STATUS_OK) return status;
  struct particles *p = &engine->particles;
  for (size_t i = 0; i < particles_slots(p); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    double at[3];
    particles_position(p, lattice, i, at);
    const double x = 2 * M_PI * (at[0] + dx / 2), z = 2 * M_PI * (at[2] + dx / 2);
    p->v[0][i] = (float)(-cos(x) * sin(z));
    p->v[2][i] = (float)(sin(x) * cos(z));
    /* The pressure that goes with it, or sound would ring. */
    p->state[i] = (float)(-0.25 * (cos(2 * x) + cos(2 * z)) / 100);
  }
  engine->speed_max = 1;
  return STATUS_OK;
}

/* Sum of the squared speeds; the largest speed into *most, where that is not NULL. */
static inline double test_vortex_energy(const struct engine *engine, double *most) {
  const struct particles *p = &engine->particles;
  double energy = 0, largest = 0;
  for (size_t i = 0; i < particles_slots(p); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    const double vx = (double)p->v[0][i], vz = (double)p->v[2][i];
    energy += vx * vx + vz * vz;
    largest = fmax(largest, vx * vx + vz * vz);
  }
  if (most != NULL) *most = sqrt(largest);
  return energy;
}

#endif
