/* Flows of the engine marched in time through geometries given by their wall distance. */
#ifndef TOSUI_TESTS_UNIT_ENGINE_MARCH_H
#define TOSUI_TESTS_UNIT_ENGINE_MARCH_H

#include "sphsolve/wcsph/state.h"
#include "tests/unit/engine_lattice.h"

/* Signed distance to the wall, positive in the fluid, at a point in spacings. */
typedef double test_distance(const double at[3], const double parameter[4]);

static inline struct lattice test_geometry(int dimensions, const size_t size[3], double dx,
                                           test_distance *distance, const double parameter[4]) {
  struct lattice l = test_lattice(dimensions, size[0], size[1], size[2], dx, dx, dx);
  for (size_t s = 0; s < l.count; s++) {
    const size_t index[3] = {s % l.size[0], s / l.size[0] % l.size[1], s / l.size[0] / l.size[1]};
    double at[3];
    for (int a = 0; a < 3; a++) at[a] = (double)index[a] + 0.5;
    double d = distance(at, parameter);
    l.wall_distance[s] = (float)(d * dx);
    l.kind[s] = d > 0 ? SITE_FLUID : SITE_WALL;
  }
  test_recount(&l);
  return l;
}

/* A slit of width p0, period p1 along the unit normal (p2, p3) in x and z. */
static inline double test_turned_slit(const double at[3], const double p[4]) {
  double along = at[0] * p[2] + at[2] * p[3], x = along - floor(along / p[1]) * p[1];
  return x < p[0] ? fmin(x, p[0] - x) : -fmin(x - p[0], p[1] - x);
}

struct march {
  enum kernel kernel; /* quintic, if not said */
  enum pass_wall wall;
  double nu, force[3], end; /* SI */
  double sound;             /* m/s; 0: 2 nu/h */
  double tolerance;         /* ends when steady by the program's own rule; 0: at `end` */
};

static inline double test_sound(const struct lattice *l, const struct march *m) {
  return m->sound > 0 ? m->sound : 2 * m->nu / (2.9 * l->spacing[0] / 3);
}

static inline struct engine_settings test_march_settings(const struct lattice *l,
                                                         const struct march *m) {
  double dx = l->spacing[0], c = test_sound(l, m);
  struct engine_settings s = test_settings_of(m->kernel, l, m->wall, 2.9 * dx);
  struct lattice_modes modes =
      lattice_modes_find(s.kernel, l->dimensions, l->spacing, s.smoothing_length);
  const bool sites = m->wall == PASS_EULERIAN; /* see wcsph_sound_for_dt */
  double viscous = 2 / (m->nu * modes.laplacian), sound = (sites ? 1 : 2) / (c * modes.gradient);
  double q = sound / viscous;
  s.kinematic_viscosity = m->nu;
  s.sound_speed = c;
  s.dt = 0.8 * sound * (sqrt(q * q / 4 + 1) - q / 2);
  memcpy(s.force, m->force, sizeof s.force);
  s.pressure_diffusion =
      (sites ? WCSPH_STABILISATION_EULERIAN : WCSPH_STABILISATION) * dx * dx / m->nu * c * c;
  return s;
}

/* Darcy velocity along the force, mean of the last tenth of the time, or as the program has it
 * where there is a tolerance: sampled 50 times a viscous time of the mean pore (wcsph/method.c).
 * `travel`: how far the fluid has moved by then, spacings (NULL: not asked). NAN where the engine
 * fails. */
static inline double test_march(const struct lattice *l, const struct march *m, double *travel) {
  struct engine engine;
  struct engine_settings settings = test_march_settings(l, m);
  if (engine_make(l, &settings, &engine) != STATUS_OK) return NAN;
  struct monitor monitor = {0};
  double force = 0, sum = 0, moved = 0;
  double gap = (wcsph_gap(l) + (m->wall == PASS_FROZEN)) * l->spacing[0];
  for (int a = 0; a < 3; a++) force = hypot(force, m->force[a]);
  int64_t steps = (int64_t)ceil(m->end / settings.dt), first = steps * 9 / 10, n = 0;
  int64_t every = m->tolerance > 0 ? (int64_t)fmax(1, gap * gap / m->nu / 50 / settings.dt) : 8;
  for (int64_t s = 1; s <= steps; s++) {
    struct wcsph_totals totals;
    if (engine_step(&engine) != STATUS_OK) break;
    if (s % every != 0 && s != steps) continue;
    if (wcsph_sum(&engine, true, &totals) != STATUS_OK) break;
    double v = 0;
    for (int a = 0; a < 3; a++) v += totals.flux[a] * m->force[a] / force;
    moved += (double)every * settings.dt * v / (double)l->fluid_count / l->spacing[0];
    if (s > first) sum += v / l->bulk_count, n++;
    if (!(m->tolerance > 0)) continue;
    if (monitor_add(&monitor, (double[MONITOR_COMPONENTS]){v / l->bulk_count})) break;
    struct monitor_verdict verdict = monitor_judge(&monitor, m->tolerance, 80);
    sum = verdict.mean[0], n = 1;
    if (verdict.steady) break;
  }
  monitor_free(&monitor);
  engine_free(&engine);
  if (travel != NULL) *travel = moved;
  return sum / (double)n;
}

/* Grains packed at random: balls of radius p1 (spacings) in a periodic box of p0^3, as many as p2,
 * drawn from the seed p3; they may overlap. */
static inline double test_balls(const double at[3], const double p[4]) {
  uint64_t state = (uint64_t)p[3];
  double nearest = INFINITY;
  for (int ball = 0; ball < (int)p[2]; ball++) {
    double square = 0;
    for (int a = 0; a < 3; a++) {
      double x = at[a] / p[0] - test_random(&state);
      x -= round(x);
      square += x * x * p[0] * p[0];
    }
    nearest = fmin(nearest, sqrt(square) - p[1]);
  }
  return nearest;
}

#endif
