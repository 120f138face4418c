/* Wells and drains take water out of soil. In their region
 *   div v_D = -q,   q >= 0 the outflow per bulk volume, 1/s.
 * A well's q is its rate over the volume of its particles. A drain holds
 *   P = P_d = rho g (head - z), at least 0, the atmospheric pressure,
 * where P would be above it. Within the drain each row gets c (P - P_d), with c so large that P is
 * P_d. A particle i beside it is linked to those within; of such a link, which is as long as r_ij,
 * only the part t up to the face of the drain lies in soil, and resistances add (isph/link.h, with
 * a drain for a soil that has none). So the link carries
 *   a_ij/t [ P_i - P_f - rho f.(x_i - x_f) ],   P_f = P_d at the face, x_f,
 * and not a_ij [ P_i - P_d(x_j) - rho f.r_ij ], as if the face were at the next particle: without
 * that, a drain of 4 spacings takes 4 to 7 % too little. (In finite differences: Gibou, Fedkiw,
 * Cheng, Kang 2002, J. Comput. Phys. 176, second order and symmetric.) The gradient of P at i has
 * the same links. The solve is repeated until each particle either gives water and is above P_d, or
 * neither (active sets: Hintermueller, Ito, Kunisch 2003, SIAM J. Optim. 13).
 *
 * What the velocities v* bring into these rows goes to the drain itself: water that slows down
 * within it is not compressed, and as a source it would hold back what follows. The first solve is
 * exact for the links; what its velocities then leave there, where they change over a spacing, is
 * the error of their sums, and no flow.
 *
 * What has left is accumulated as mass and removed in whole particles: once it is the mass of one,
 * the particle with the largest kernel sum in the region is taken out. So the water that left is
 * what was taken plus what is pending, which is less than a particle. If a drain's q turns negative
 * within a step, it is subtracted from the pending mass; no particle ever comes out of a drain. */
#include "sphsolve/isph/well.h"

#include <math.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/ranks.h"
#include "common/units.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/mobility.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/constants.h"

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

/* Whether a particle is in a drain, or linked to one. */
static bool drains(const struct isph_outlet *outlet) {
  return outlet->inside > 0 || outlet->tie > 0;
}

/* Whether x lies in a box, or within `reach`. */
static bool holds(const struct isph *s, const double box[6], const double x[3], double reach) {
  for (int a = 0; a < 3; a++)
    if (isph_uses_axis(s, a) && !(x[a] >= box[a] - reach && x[a] < box[a + 3] + reach))
      return false;
  return true;
}

/* 1 + the number of the well or drain that holds x, or is within `reach`; 0: none. */
static int32_t well_at(const struct isph *s, const double x[3], double reach) {
  for (size_t w = 0; w < s->well_count; w++) {
    const struct region *whole = s->wells[w].region;
    if (!holds(s, whole->extent, x, reach)) continue;
    for (size_t k = whole->first; k < whole->end; k++)
      if (holds(s, s->scene->regions[k].box, x, reach)) return (int32_t)w + 1;
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

/* The part t of the way x - t r, 0 <= t <= 1, to an image up to a drain, 1 if it does not enter it;
 * `face`: where that is. */
static double path_outside(const struct isph *s, const struct region *drain,
                           const struct isph_image *image, const double x[3], const double r[3],
                           double face[3]) {
  struct isph_leg leg = isph_first_leg(x, r);
  double least = 1;
  while (least == 1 && isph_next_leg(image, &leg)) {
    const double *at = leg.start, *step = leg.step;
    const double middle[3] = {at[0] + 0.5 * step[0], at[1] + 0.5 * step[1], at[2] + 0.5 * step[2]};
    for (size_t k = drain->first; k < drain->end; k++) {
      if (isph_soil_is_far(s, s->scene->regions[k].box, k, s->support_max, at)) continue;
      const struct isph_box box = isph_soil_box(s, k, 0, middle);
      double from = leg.from, to = leg.to;
      if (isph_box_clip(&box, at, step, &from, &to)) least = fmin(least, from);
    }
    least = fmax(PATH_LEAST, least);
    for (int a = 0; a < 3; a++) face[a] = at[a] + least * step[a];
  }
  return least;
}

/* Sums up the links of a particle outside that are cut by a drain: what they carry beyond plain
 * ones, a_ij [ P_i - P_d(x_j) - rho f.(x_i - x_j) ], is tie (P_i - held). */
static void cut_links(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                      struct isph_outlet *outlet) {
  const double *xi = s->position[i], rho = s->density;
  double load = 0;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const uint32_t entry = chunk->pair[p], j = entry & PAIR_MASK;
    const int32_t well = s->outlet[j].inside;
    if (well == 0 || (outlet->tie > 0 && well != outlet->well)) continue;
    const struct region *drain = s->wells[well - 1].region;
    const struct isph_image *image = &s->image[entry >> PAIR_BITS];
    double r[3], face[3] = {0}, fall = 0, whole = 0;
    isph_separation(s, xi, s->position, entry, r);
    const double part = path_outside(s, drain, image, xi, r, face);
    for (int c = 0; c < 3; c++) {
      const double straight = image->turn[c] < 0 ? xi[c] - s->position[j][c] : r[c];
      fall += rho * s->force[c] * (xi[c] - face[c]), whole += rho * s->force[c] * straight;
    }
    const double weight = s->volume[j] * (double)chunk->slope[p], more = 1 / part - 1;
    const double a = 2 * s->volume[i] * weight * isph_mobility_between(s, chunk, p, i, j);
    outlet->well = well;
    outlet->tie += a * more;
    load += a * ((drain_pressure(s, drain, face[2]) + fall) / part -
                 (drain_pressure(s, drain, s->position[j][2]) + whole));
    for (int c = 0; c < 3; c++) outlet->pull[c] += weight * more * r[c];
  }
  if (outlet->tie > 0) outlet->held = load / outlet->tie;
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

/* Which well or drain the particle is in, on this rank or beside it. */
static void find_inside(struct isph *s, size_t i) {
  const double *x = s->position[i];
  struct isph_outlet *outlet = &s->outlet[i];
  *outlet = (struct isph_outlet){.well = well_at(s, x, 0)};
  if (outlet->well == 0 || s->wells[outlet->well - 1].region->type != REGION_DRAIN) return;
  outlet->inside = outlet->well;
  outlet->held = drain_pressure(s, s->wells[outlet->well - 1].region, x[2]);
}

/* Which of the particles that are beside one give water to it. */
static void find_outlets(struct isph *s, const struct isph_chunk *chunk) {
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    struct isph_outlet *outlet = &s->outlet[i];
    const int32_t near = well_at(s, s->position[i], 0.5 * s->size[i]);
    outlet->within = near > 0;
    if (outlet->well == 0) outlet->well = near;
    const bool pumped = near > 0 && s->wells[near - 1].region->type == REGION_WELL;
    if (outlet->inside == 0 && !pumped && well_at(s, s->position[i], s->support_max) > 0)
      cut_links(s, chunk, i, outlet);
    outlet->gives = drains(outlet) && s->pressure[i] > outlet->held;
  }
}

void isph_wells_begin(struct isph *s, double dt) {
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < s->count; i++) find_inside(s, i);
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) find_outlets(s, &s->chunks[c]);
  for (size_t w = 0; w < s->well_count; w++) {
    const struct region *region = s->wells[w].region;
    if (region->type != REGION_WELL) continue;
    const double rate = rate_of(s, region, dt) / sum_of(s, w, false);
    for (size_t i = s->local.begin; i < s->local.end; i++)
      if (s->outlet[i].well == (int32_t)w + 1) s->outlet[i].flow = rate * s->volume[i];
  }
}

void isph_wells_row(const struct isph *s, size_t i, struct effect_row *row) {
  struct isph_outlet *outlet = &s->outlet[i];
  if (outlet->well == 0) return;
  if (s->wells[outlet->well - 1].region->type == REGION_WELL) row->source -= outlet->flow;
  if (!outlet->gives) return;
  outlet->passed = s->solve.again ? 0 : row->passed;
  if (outlet->inside > 0) outlet->tie = DRAIN_COEFFICIENT * row->diagonal;
  row->diagonal += outlet->tie, row->tied += outlet->tie;
  /* the second solution is an increment of the pressure */
  if (!s->solve.again) row->source += outlet->tie * outlet->held;
}

void isph_wells_gradient(const struct isph *s, size_t i, double gradient[3]) {
  const struct isph_outlet *outlet = &s->outlet[i];
  if (!outlet->gives || outlet->inside > 0) return;
  const double above = s->pressure[i] - (s->solve.again ? 0 : outlet->held);
  for (int a = 0; a < 3; a++) gradient[a] += above * outlet->pull[a];
}

bool isph_wells_change(struct isph *s) {
  bool changed = false;
  double most = 0;
  for (size_t i = s->local.begin; i < s->local.end; i++) most = fmax(most, fabs(s->pressure[i]));
  const double near = s->scene->isph.tolerance * ranks_max(most); /* as exactly as P is solved */
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    struct isph_outlet *outlet = &s->outlet[i];
    if (!drains(outlet)) continue;
    const double above = s->pressure[i] - outlet->held;
    if (outlet->gives ? above >= -near : above <= near) continue;
    outlet->gives = !outlet->gives;
    changed = true;
  }
  return ranks_any(changed);
}

void isph_wells_solved(struct isph *s) {
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    struct isph_outlet *outlet = &s->outlet[i];
    if (!outlet->gives) continue;
    outlet->flow += outlet->passed;
    outlet->flow += outlet->tie * (s->pressure[i] - (s->solve.again ? 0 : outlet->held));
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
    if (s->outlet[i].well != (int32_t)w + 1 || !s->outlet[i].within || s->outlet[i].leaves)
      continue;
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
