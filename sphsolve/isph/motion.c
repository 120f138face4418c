#include "sphsolve/isph/motion.h"

#include <math.h>
#include <string.h>

#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/calm.h"
#include "sphsolve/isph/effects/shifting.h"
#include "sphsolve/isph/effects/surface.h"
#include "sphsolve/isph/effects/turbulence.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/packing.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/vector.h"
#include "sphsolve/isph/energy.h"
#include "sphsolve/isph/near_surface.h"
#include "sphsolve/isph/wall.h"

static void wrap(const struct isph *s, double x[3]) {
  for (int a = 0; a < 3; a++) {
    if (!s->periodic[a]) continue;
    double length = s->high[a] - s->low[a];
    x[a] -= length * floor((x[a] - s->low[a]) / length);
    if (x[a] >= s->high[a]) x[a] = s->low[a];
  }
}

/* Whether there is a gap between particle i and a wall, 0 .. 1: the particle is on the surface, or
 * more asymmetric than disorder makes it, and the void lies towards the wall. */
static double beside_gap(const struct isph *s, const struct isph_chunk *chunk, size_t i) {
  const double *xi = s->position[i];
  double gap = 0, trace = 0, r[3];
  for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
    double mirror[6];
    isph_separation(s, xi, s->boundary_position, chunk->wall[p], r);
    double xj[3] = {xi[0] - r[0], xi[1] - r[1], xi[2] - r[2]};
    isph_wall_mirror(s, i, chunk->wall[p] & PAIR_MASK, xj, mirror, NULL);
    gap = fmax(gap, surface_gap(s, i, r, mirror));
    trace += isph_wall_volume(s, chunk->wall[p] & PAIR_MASK) * (double)chunk->wall_slope[p] *
             (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  }
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    if (!isph_is_reflected((enum isph_images)s->images[i], s, chunk->pair[p])) continue;
    isph_separation(s, xi, s->position, chunk->pair[p], r);
    gap = fmax(gap, isph_reflection_gap(s, i, chunk->pair[p], r));
  }
  if (gap == 0) return 0;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    isph_separation(s, xi, s->position, chunk->pair[p], r);
    trace += s->volume[chunk->pair[p] & PAIR_MASK] * (double)chunk->slope[p] *
             (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  }
  double asymmetry = surface_asymmetry(s, s->support[i], s->gradient_sum[i], trace);
  double more = (asymmetry - SURFACE_DISORDER) / (SURFACE_FROM - SURFACE_DISORDER);
  return gap * fmax(s->surface[i], fmin(1, fmax(0, more)));
}

/* How level a surface is, 0 to 1: the square of the cosine between its normal and the upward
 * direction. */
static double level_of(const double force[3], const double normal[3]) {
  const double up = -dot(force, normal), square = dot(force, force);
  return up > 0 ? up * up / square : 0;
}

/* Displacement of particle i by shifting. Returns the potential energy per mass by which it lifts
 * free water, over soil only near a surface, -f.dx, which isph_energy_bound_lift limits. */
static double shift(const struct isph *s, const struct isph_chunk *chunk, size_t i, double dt,
                    double step[3]) {
  const double *v = s->velocity[i], h = 0.5 * s->support[i];
  double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), weight = 1, near = 0;
  double normal[3] = {0}, eps = s->on.soil ? s->porosity[i] : 1;
  if (s->on.surface) {
    weight = (1 - (1 - isph_calm_surface(s, i)) * s->surface[i]) * (1 - beside_gap(s, chunk, i));
    near = s->near[i];
    if (near > 0) isph_surface_normal(s, chunk, i, normal);
  }
  speed = fmax(speed, h * strain_rate(s->gradient[i])) / eps;
  double size = s->size[i];
  double most = isph_is_driven(s) ? SHIFT_SHARE * size * size / s->shift_stiffness : h * h;
  shift_of(s->gradient_sum[i], h, speed, dt, size, most, weight, step);
  if (near > 0) shift_along(normal, near, s->on.soil ? level_of(s->force, normal) : 0, step);
  if (!s->on.soil) return -dot(s->force, step);
  return s->soil_fraction[i] > 0 ? 0 : -near * dot(s->force, step);
}

/* Finds the advection velocities (`speeds`), the shifts (`steps`) and the energy by which these
 * lift the water (`lift`). */
static void find_moves(struct isph *s, double dt, double (*speeds)[3], double (*steps)[3],
                       double *lift) {
  const bool waves = s->on.surface && (!isph_is_unforced(s) || s->surface_pressure != NULL);
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      double *v = s->velocity[i], eps = s->on.soil ? s->porosity[i] : 1;
      const double *carried = waves ? v : s->predicted[i];
      struct budget_sums *sums = &s->chunks[c].budget;
      double beyond[3], held[3];
      memcpy(held, v, sizeof held);
      isph_wall_guard(s, s->position[i], 1 / eps, dt, v);
      isph_budget_change(s, sums, BUDGET_WALL_GUARD, i, held);
      for (int a = 0; a < 3; a++) {
        speeds[i][a] = carried[a] / eps;
        beyond[a] = speeds[i][a] * dt - held[a] / eps * dt;
        held[a] *= dt / eps, steps[i][a] = 0;
      }
      isph_budget_displacement(s, sums, BUDGET_FORCE, i, held);
      isph_budget_displacement(s, sums, s->on.surface ? BUDGET_WALL_GUARD : BUDGET_TIME_STEP, i,
                               beyond);
      lift[i] = s->on.shifting ? shift(s, &s->chunks[c], i, dt, steps[i]) : 0;
    }
}

/* Sums over the neighbours: of their weights V slope, and of the weighted steps; in soil limits
 * `share` to the least fraction of soil among them. */
ROW void steps_around(enum isph_images images, const struct isph *s, const struct isph_chunk *chunk,
                      size_t i, double (*steps)[3], double sum[3], double *weights, double *share) {
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const uint32_t j = chunk->pair[p] & PAIR_MASK;
    const double weight = s->volume[j] * (double)chunk->slope[p];
    if (s->on.soil) *share = fmin(*share, s->soil_fraction[j]);
    double step[3];
    isph_turn(images, s, chunk->pair[p], steps[j], step);
    for (int a = 0; a < 3; a++) sum[a] += weight * step[a];
    *weights += weight;
  }
}

/* Subtracts from the steps in soil and in thick water (isph/calm.h) a share of the mean of their
 * neighbourhoods, in which a particle's own step has the mean weight of its pairs. */
static void subtract_mean_shift(struct isph *s, double (*steps)[3]) {
  double *const mean[3] = {s->work[1], s->work[2], s->work[3]}; /* free for reuse at this point */
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(steps)});
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) {
    const struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++) {
      double sum[3] = {0}, weights = 0, share = s->on.soil ? s->soil_fraction[i] : s->thick[i];
      if (s->on.soil && s->on.surface) share *= 1 - s->near[i];
      if (share > 0) ISPH_ROW(s, i, steps_around, s, chunk, i, steps, sum, &weights, &share);
      const double own = weights / fmax(1, s->pair_number[i]);
      for (int a = 0; a < 3; a++)
        mean[a][i] = weights > 0 ? share * ((sum[a] + own * steps[i][a]) / (weights + own)) : 0;
    }
  }
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++)
    for (int a = 0; a < 3; a++) steps[i][a] -= mean[a][i];
}

void isph_move(struct isph *s, double dt) {
  /* v* and the next two arrays are free for reuse at this point */
  double(*displacement)[3] = s->predicted;
  double(*steps)[3] = s->scratch, *lift = s->work[0];
  find_moves(s, dt, displacement, steps, lift);
  if ((s->calm != NULL || s->on.soil) && s->on.shifting) subtract_mean_shift(s, steps);
  if (isph_shifting_is_bound(s)) isph_energy_bound_lift(s, lift, steps);
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      double *v = s->velocity[i], *speed = displacement[i], guided[3], beyond[3];
      const double *step = steps[i];
      const float *g = s->gradient != NULL ? s->gradient[i] : NULL;
      struct budget_sums *sums = &s->chunks[c].budget;
      memcpy(guided, v, sizeof guided);
      for (int a = 0; g != NULL && s->on.shifting && a < 3; a++)
        v[a] += (double)g[3 * a] * step[0] + (double)g[3 * a + 1] * step[1] +
                (double)g[3 * a + 2] * step[2];
      isph_budget_change(s, sums, BUDGET_SHIFTING, i, guided);
      isph_budget_displacement(s, sums, BUDGET_SHIFTING, i, step);
      for (int a = 0; a < 3; a++) beyond[a] = speed[a] += step[a] / dt;
      isph_wall_guard(s, s->position[i], 1, dt, speed);
      for (int a = 0; a < 3; a++) beyond[a] = (speed[a] - beyond[a]) * dt;
      isph_budget_displacement(s, sums, BUDGET_WALL_GUARD, i, beyond);
      for (int a = 0; a < 3; a++) speed[a] = s->dimensions == 3 || a != 1 ? speed[a] * dt : 0;
    }
  if (s->on.energy)
    isph_energy_limit_displacement(s, displacement, s->energy_step.kinetic + s->energy_step.given);
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    for (int a = 0; a < 3; a++) s->position[i][a] += displacement[i][a];
    if (s->packing != NULL) isph_packing_fade(s, i, displacement[i]);
    wrap(s, s->position[i]);
  }
}
