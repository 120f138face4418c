/* Wells and drains take water out of soil. In their region
 *   div v_D = -q,   q >= 0 the outflow per bulk volume, 1/s.
 * A well's q is its rate over the volume of its particles. A drain's is found together with the
 * pressure,
 *   q V = c (P - P_d),   P_d = rho g (head - z), at least 0, the atmospheric pressure,
 * where P > P_d. The solve is repeated until each particle of a drain either gives water and is
 * above P_d, or neither (active sets: Hintermueller, Ito, Kunisch 2003, SIAM J. Optim. 13). c is so
 * large that P - P_d is a small part of the pressure difference over a particle (a Robin condition:
 * Bear 1972, Dynamics of Fluids in Porous Media, 7.1). What has left is accumulated as mass and
 * removed in whole particles: once it is the mass of one, the particle with the largest kernel sum
 * in the region is taken out. So the water that left is what was taken plus what is pending, which
 * is less than a particle. If a drain's q turns negative within a step, it is subtracted from the
 * pending mass; no particle ever comes out of a drain. */
#include "sphsolve/isph/well.h"

#include <math.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/ranks.h"
#include "common/units.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/constants.h"

/* c over the row's diagonal: P - P_d is then a tenth of the pressure difference to a neighbour. */
#define DRAIN_COEFFICIENT 10.0

enum status isph_wells_create(struct isph *s) {
  const struct scene *scene = s->scene;
  size_t n = 0;
  for (size_t k = 0; k < scene->region_count; k = scene->regions[k].end)
    n += region_is_sink(&scene->regions[k]);
  enum status status = memory_allocate(&s->wells, n, sizeof *s->wells, "wells");
  if (status != STATUS_OK) return status;
  for (size_t k = 0; k < scene->region_count; k = scene->regions[k].end)
    if (region_is_sink(&scene->regions[k])) s->wells[s->well_count++].region = &scene->regions[k];
  return STATUS_OK;
}

/* 1 + the number of the well or drain that holds x, or is within `reach`; 0: none. */
static int32_t well_at(const struct isph *s, const double x[3], double reach) {
  for (size_t w = 0; w < s->well_count; w++) {
    const struct region *whole = s->wells[w].region;
    for (size_t k = whole->first; k < whole->end; k++) {
      const double *box = s->scene->regions[k].box;
      bool inside = true;
      for (int a = 0; a < 3; a++)
        if (isph_uses_axis(s, a))
          inside = inside && x[a] >= box[a] - reach && x[a] < box[a + 3] + reach;
      if (inside) return (int32_t)w + 1;
    }
  }
  return 0;
}

bool isph_in_well(const struct isph *s, const double x[3]) {
  return well_at(s, x, 0) > 0;
}

/* P_d at a height, Pa. */
static double drain_pressure(const struct isph *s, const struct region *drain, double z) {
  const double *g = s->scene->gravity;
  const double strength = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  if (drain->boundary != BOUNDARY_HEAD) return 0;
  const double head =
      drain->table.count > 0 ? time_table_at(&drain->table, s->time, 0) : drain->head;
  if (strength == 0) return s->density * GRAVITY_STANDARD * head;
  return fmax(0, s->density * strength * (head - z));
}

/* Sum over a well's particles of their flow, or else of their volume, in a fixed order. */
static double sum_of(const struct isph *s, size_t well, bool flows) {
  double total;
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
      if (s->outlet[i].well == (int32_t)well + 1) sum += flows ? s->outlet[i].flow : s->volume[i];
    s->sums[c][0] = sum;
  }
  isph_sum_chunks(s, 1, &total);
  return total;
}

/* Mean rate of a well over the step. */
static double rate_of(const struct isph *s, const struct region *well, double dt) {
  return well->table.count > 0 ? time_table_integral(&well->table, s->time, s->time + dt, 0) / dt
                               : well->rate;
}

void isph_wells_begin(struct isph *s, double dt) {
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++)
    s->outlet[i] = (struct isph_outlet){.well = well_at(s, s->position[i], 0.5 * s->size[i])};
  for (size_t w = 0; w < s->well_count; w++) {
    const struct region *region = s->wells[w].region;
    const bool drain = region->type == REGION_DRAIN;
    const double volume = drain ? 1 : sum_of(s, w, false),
                 rate = drain ? 0 : rate_of(s, region, dt);
    for (size_t i = s->local.begin; i < s->local.end; i++) {
      struct isph_outlet *outlet = &s->outlet[i];
      if (outlet->well != (int32_t)w + 1) continue;
      if (drain && s->pressure[i] > drain_pressure(s, region, s->position[i][2])) outlet->tie = 1;
      if (!drain) outlet->flow = rate * s->volume[i] / volume;
    }
  }
}

void isph_wells_row(const struct isph *s, size_t i, struct effect_row *row) {
  struct isph_outlet *outlet = &s->outlet[i];
  if (outlet->well == 0) return;
  row->source -= outlet->flow;
  if (!(outlet->tie > 0)) return;
  outlet->tie = DRAIN_COEFFICIENT * row->diagonal;
  row->diagonal += outlet->tie, row->tied += outlet->tie;
  if (s->solve.again) return; /* the solution then is an increment of the pressure */
  row->source +=
      outlet->tie * drain_pressure(s, s->wells[outlet->well - 1].region, s->position[i][2]);
}

bool isph_wells_change(struct isph *s) {
  bool changed = false;
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    struct isph_outlet *outlet = &s->outlet[i];
    if (outlet->well == 0) continue;
    const struct region *region = s->wells[outlet->well - 1].region;
    if (region->type != REGION_DRAIN) continue;
    const bool gives = s->pressure[i] > drain_pressure(s, region, s->position[i][2]);
    if (gives == (outlet->tie > 0)) continue;
    outlet->tie = gives;
    changed = true;
  }
  return ranks_any(changed);
}

void isph_wells_solved(struct isph *s) {
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    struct isph_outlet *outlet = &s->outlet[i];
    if (!(outlet->tie > 0)) continue;
    const struct region *region = s->wells[outlet->well - 1].region;
    const double held = s->solve.again ? 0 : drain_pressure(s, region, s->position[i][2]);
    outlet->flow += outlet->tie * (s->pressure[i] - held);
  }
}

/* Steps in a row below vacuum or without water after which a well counts as starved: water at rest
 * takes some steps to follow a new well. */
#define STEPS_STARVED 100

/* Warns, once, if the soil does not yield the rate of a well. */
static void warn_of_rate(const struct isph *s, struct isph_well *well, int32_t number) {
  double lowest = INFINITY;
  if (well->starved >= STEPS_STARVED || well->region->type != REGION_WELL) return;
  for (size_t i = s->local.begin; i < s->local.end; i++)
    if (s->outlet[i].well == number) lowest = fmin(lowest, s->pressure[i]);
  lowest = -ranks_max(-lowest);
  const bool dry = lowest == INFINITY && well->region->rate > 0;
  well->starved = lowest < VACUUM || dry ? well->starved + 1 : 0;
  if (well->starved < STEPS_STARVED) return;
  if (dry)
    log_warning("%s:%d: t = %.4g s: no water is left in this well: the soil does not bring its "
                "rate; give a lower one, or a drain of a head",
                s->scene->path, well->region->line, s->time);
  else
    log_warning("%s:%d: t = %.4g s: the pressure in this well is %.3g Pa, below vacuum: the soil "
                "does not bring its rate; give a lower one, or a drain of a head",
                s->scene->path, well->region->line, s->time, lowest);
}

/* Finds the particle of a well, on any rank, with the largest kernel sum that is not leaving yet;
 * of several the one with the lowest id. Returns its mass; INFINITY: none. *here: its index on its
 * own rank, otherwise SIZE_MAX. */
static double next_to_leave(const struct isph *s, size_t w, size_t *here) {
  size_t best = SIZE_MAX;
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    if (s->outlet[i].well != (int32_t)w + 1 || s->outlet[i].leaves) continue;
    const double more = best == SIZE_MAX ? 1 : s->kernel_sum[i] - s->kernel_sum[best];
    if (more > 0 || (more == 0 && s->id[i] < s->id[best])) best = i;
  }
  double own = best == SIZE_MAX ? -INFINITY : s->kernel_sum[best];
  const double closest = ranks_max(own);
  if (closest == -INFINITY) return INFINITY;
  if (own < closest) best = SIZE_MAX;
  own = best == SIZE_MAX ? -INFINITY : -(double)s->id[best];
  if (own < ranks_max(own)) best = SIZE_MAX;
  *here = best;
  return ranks_max(best == SIZE_MAX ? 0 : s->mass[best]);
}

void isph_wells_take(struct isph *s, double dt) {
  for (size_t w = 0; w < s->well_count; w++) {
    struct isph_well *well = &s->wells[w];
    warn_of_rate(s, well, (int32_t)w + 1);
    well->flow = sum_of(s, w, true);
    well->pending += s->density * well->flow * dt;
    for (;;) {
      size_t here = SIZE_MAX;
      const double mass = next_to_leave(s, w, &here);
      if (!(well->pending >= mass)) break;
      if (here != SIZE_MAX) s->outlet[here].leaves = true;
      well->pending -= mass, well->taken += mass;
    }
  }
}
