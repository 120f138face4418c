#include "sphsolve/isph/energy.h"

#include <math.h>
#include <string.h>

#include "sphsolve/isph/effects/relaxation.h"
#include "sphsolve/isph/effects/shifting.h"
#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/vector.h"
#include "sphsolve/isph/constants.h"

/* In a closed tank under a steady force the energy of the water, kinetic and potential,
 *   E = sum m (v^2 / (2 eps^2) - f.x),
 * cannot increase. Three errors of the method raise it; they show near rest, where nothing else
 * dissipates energy.
 *
 * Relaxation of the density (effects/relaxation.h) lets compressed water expand, which lifts the
 * water above it. The work in a step,
 *   R = sum P V (phi - 1) eps B/tau dt,
 * is limited to what friction dissipates and contraction elsewhere gives back in the same step,
 * with the pressures of the step before:
 *   relaxation_factor <= (friction + contraction) / expansion,
 * unless the water as a whole is too dense by more than DENSITY_EXCESS: then its volume matters
 * more. Friction is measured by the kinetic energy that v* has lost, which is at most m u^2/2 for a
 * particle. Seeping water has hardly any kinetic energy, and drag takes in a step
 *   m dt (a + b |v|) v.u,
 * which is some hundred times as much in fine soil. This allows crowded particles in soil to
 * spread: the part of their expansion that drag would hold back (effects/relaxation.h) is limited
 * to what drag takes, and to that alone,
 *   crowd_factor <= drag / expansion of that part.
 * The rest may not use that energy: otherwise seepage would pay for free water that stirs.
 *
 * Shifting lifts free water near a surface while it lies on soil (effects/shifting.h); this is
 * limited to friction and to what shifting lowers elsewhere,
 *   lift_factor <= (friction + sum of -m f.dx < 0) / sum of -m f.dx > 0,
 * with friction as above. Otherwise three rows of uneven water stir themselves for ever. That holds
 * whatever else drives the water, so this limit is not the effect's alone but shifting's. Without
 * soil, beside windows, all of the water is so limited, at any depth: shallow water
 * beside a window took ten times as much from shifting as friction dissipated, and went on
 * sloshing.
 *
 * The projection, whose gradient and divergence are adjoint only up to sum V grad W, and shifting
 * raise the water by 1e-7 to 1e-6 of its energy in a step, as they spread the particles. This is
 * compensated by a uniform strain: all particles move along the force towards the lowest one, by so
 * much that E^{n+1} = E^n. Velocities are not scaled for this purpose: waves hold less than 1e-5 of
 * the energy and would pay for all of it (a wave of 3 cm/s on a metre of water died within two
 * periods). Only what a new porosity adds to u = v/eps is taken from the velocities. The inertial
 * term C_r/eps Dv/Dt conserves v of water that crosses the face of soil: its m u^2/2 grows by (m
 * v^2/2) D(1/eps^2), for which no pressure does work. As much as the step's move has added is
 * taken, however much it is. */

static double kinetic_of(const struct isph *s, double (*velocity)[3]) {
  double total;
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double *v = velocity[i], eps = s->on.soil ? s->porosity[i] : 1;
      sum += 0.5 * s->mass[i] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / (eps * eps);
    }
    s->sums[c][0] = sum;
  }
  isph_sum_chunks(s, 1, &total);
  return total;
}

double isph_kinetic_energy(const struct isph *s) {
  return kinetic_of(s, s->velocity);
}

double isph_potential_energy(const struct isph *s) {
  const double *f = s->force;
  double total;
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double *x = s->position[i];
      sum -= s->mass[i] * (f[0] * x[0] + f[1] * x[1] + f[2] * x[2]);
    }
    s->sums[c][0] = sum;
  }
  isph_sum_chunks(s, 1, &total);
  return total;
}

/* Energy that drag takes from particle i in a step at its present velocity, J or J/m. */
static double taken_by_drag(const struct isph *s, size_t i, double dt) {
  const double *v = s->velocity[i];
  double linear[3], forchheimer[3];
  isph_budget_drag(s, i, v, v, linear, forchheimer);
  return -s->mass[i] * dt * (dot(linear, v) + dot(forchheimer, v)) / s->porosity[i];
}

void isph_energy_find_friction(struct isph *s) {
  s->friction = isph_kinetic_energy(s) - kinetic_of(s, s->predicted);
}

void isph_energy_limit_relaxation(struct isph *s, double relaxation_time, double dt) {
  enum { EXPANDS, CONTRACTS, CROWD, DRAG, EXCESS, VOLUME, COUNT };
  double total[COUNT];
  s->relaxation_factor = s->crowd_factor = 1;
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum[COUNT] = {0};
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      double asked = -s->volume[i] * relaxation_source(s, i, relaxation_time);
      double crowd = -s->volume[i] * relaxation_crowd(s, i, relaxation_time);
      double given = s->pressure[i] * (asked - crowd) * dt;
      sum[CROWD] += fmax(0, s->pressure[i] * crowd * dt);
      if (s->on.soil) sum[DRAG] += taken_by_drag(s, i, dt);
      sum[given > 0 ? EXPANDS : CONTRACTS] += fabs(given);
      sum[EXCESS] += asked * relaxation_time, sum[VOLUME] += s->volume[i];
    }
    memcpy(s->sums[c], sum, sizeof sum);
  }
  isph_sum_chunks(s, COUNT, total);
  double free = fmin(1, total[EXCESS] / total[VOLUME] / DENSITY_EXCESS - 1);
  if (total[EXPANDS] > 0)
    s->relaxation_factor = fmin(1, fmax(0, s->friction + total[CONTRACTS]) / total[EXPANDS]);
  s->relaxation_excess = free > s->relaxation_factor ? 1 - s->relaxation_factor / free : 0;
  s->relaxation_factor = fmax(s->relaxation_factor, free);
  if (total[CROWD] > 0) s->crowd_factor = fmin(1, total[DRAG] / total[CROWD]);
}

double isph_energy_from_relaxation(const struct isph *s, double relaxation_time, double dt) {
  double total;
  if (s->relaxation_excess <= 0) return 0;
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double crowd = s->crowd_factor * relaxation_crowd(s, i, relaxation_time);
      const double source = relaxation_source(s, i, relaxation_time) - crowd;
      sum -= s->pressure[i] * s->volume[i] * source;
    }
    s->sums[c][0] = sum;
  }
  isph_sum_chunks(s, 1, &total);
  return s->relaxation_excess * fmax(0, total * dt);
}

void isph_energy_bound_lift(const struct isph *s, const double *lift, double (*steps)[3]) {
  enum { LIFTS, LOWERS, COUNT };
  const double *f = s->force, square = dot(f, f);
  double total[COUNT];
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum[COUNT] = {0};
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
      sum[lift[i] > 0 ? LIFTS : LOWERS] += s->mass[i] * fabs(lift[i]);
    memcpy(s->sums[c], sum, sizeof sum);
  }
  isph_sum_chunks(s, COUNT, total);
  const double allowed = fmax(0, s->friction) + total[LOWERS];
  if (!(total[LIFTS] > allowed && square > 0)) return;
  const double less = 1 - allowed / total[LIFTS];
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++)
    for (int a = 0; a < 3; a++) steps[i][a] += less * fmax(0, lift[i]) / square * f[a];
}

#define STRAIN_MAX 1e-3 /* largest strain in a step */

void isph_energy_limit_displacement(struct isph *s, double (*displacement)[3], double available) {
  enum { WORK, WEIGHT, MASS, COUNT };
  const double *f = s->force, force = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  double total[COUNT], lowest = -INFINITY;
#pragma omp parallel for schedule(static) reduction(max : lowest)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum[COUNT] = {0};
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double *x = s->position[i];
      double depth = (f[0] * x[0] + f[1] * x[1] + f[2] * x[2]) / force;
      sum[WORK] -= s->mass[i] * (f[0] * displacement[i][0] + f[1] * displacement[i][1] +
                                 f[2] * displacement[i][2]);
      sum[WEIGHT] -= s->mass[i] * force * depth, sum[MASS] += s->mass[i];
      lowest = fmax(lowest, depth);
    }
    memcpy(s->sums[c], sum, sizeof sum);
  }
  isph_sum_chunks(s, COUNT, total);
  lowest = ranks_max(lowest);
  const double weight = total[WEIGHT] + total[MASS] * force * lowest;
  double excess = isph_kinetic_energy(s) + total[WORK] - available;
  if (!(excess > 0 && weight > 0)) return;
  double strain = fmin(excess / weight, STRAIN_MAX) / force;
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double *x = s->position[i];
      double down[3], depth = (f[0] * x[0] + f[1] * x[1] + f[2] * x[2]) / force;
      for (int a = 0; a < 3; a++)
        down[a] = strain * (lowest - depth) * f[a], displacement[i][a] += down[a];
      isph_budget_displacement(s, &s->chunks[c].budget, BUDGET_ENERGY_BOUND, i, down);
    }
}

void isph_energy_limit_velocity(struct isph *s, double most, double moved) {
  double kinetic = isph_kinetic_energy(s), excess = kinetic + isph_potential_energy(s) - most;
  if (!(excess > 0 && kinetic > 0)) return;
  double scale = sqrt(1 - fmin(excess, fmax(TRIM_MAX * kinetic, kinetic - moved)) / kinetic);
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    struct isph_chunk *chunk = &s->chunks[c];
    memset(&chunk->budget, 0, sizeof chunk->budget);
    for (size_t i = chunk->begin; i < chunk->end; i++) {
      double from[3];
      memcpy(from, s->velocity[i], sizeof from);
      for (int a = 0; a < 3; a++) s->velocity[i][a] *= scale;
      isph_budget_change(s, &chunk->budget, BUDGET_ENERGY_BOUND, i, from);
    }
  }
  isph_sum_budgets(s);
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->velocity)});
}
