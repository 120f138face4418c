/* Rain: a region from which water falls at a given rate onto what lies below it. It comes in whole
 * particles, each with the mass of all others. What falls on the area of a region is accumulated as
 * mass; once it is that of a particle, one is placed where a drop falling there would come to rest.
 * So the water of any rate over any time is correct to less than one particle, also if it is less
 * than a row. The drop has no velocity, and brings no momentum.
 *
 * The places follow each other by the golden ratio (in 3-D by the two numbers that replace it:
 * Roberts 2018, "The unreasonable effectiveness of quasirandom sequences"): any section of the
 * sequence covers the area evenly, and a run resumed from a checkpoint continues it.
 *
 * A source div v = q in the particles at the surface instead, as wells have a sink, would lift the
 * surface twice: by spreading its particles, and by the particle that is added. In a well, the
 * particle that is removed is the one that its sink has compressed. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_RAIN_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_RAIN_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/method.h"
#include "sphsolve/isph/own.h"
#include "sphsolve/isph/particles.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/output/history_columns.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/constants.h"

/* Most places tried in a step for a drop that finds no room. */
#define RAIN_PLACES_MAX 64
/* Share of a particle's mass that the sum over steps may lack by rounding. */
#define RAIN_ROUNDING 1e-9

static inline double isph_rain_area(const struct scene *scene, const struct region *rain) {
  const double *b = rain->box;
  return (b[3] - b[0]) * (scene->dimensions == 3 ? b[4] - b[1] : 1);
}

/* x and y of place number n of a rain. */
static inline void rain_find_place(const struct isph *s, const struct region *rain, double n,
                                   double x[3]) {
  const double steps[2][2] = {{GOLDEN_1, 0}, {GOLDEN_2X, GOLDEN_2Y}};
  for (int a = 0; a < 2; a++) {
    const double step = steps[s->dimensions == 3][a], at = 0.5 + n * step;
    x[a] = rain->box[a] + (at - floor(at)) * (rain->box[a + 3] - rain->box[a]);
  }
}

static inline bool rain_is_over(const struct isph *s, const double x[3], const double low[3],
                                const double high[3]) {
  for (int a = 0; a < 2; a++)
    if (isph_uses_axis(s, a) && !(x[a] >= low[a] && x[a] < high[a])) return false;
  return true;
}

/* Size at x of a particle of this mass: the side of its bulk volume. */
static inline double rain_size_at(const struct isph *s, const double x[3], double mass) {
  struct soil_point soil = {.porosity = 1};
  if (s->on.soil) isph_soil_at(s, x, 0, &soil);
  return isph_size_of(s, mass / (soil.porosity * s->density));
}

/* Height at which a drop of half size `half` rests on the ground below `top` at x: on the highest
 * wall, at the face of the highest soil, or on the domain's floor. INFINITY if a wall covers the
 * top. */
static inline double rain_ground_at(const struct isph *s, const double x[3], double top,
                                    double half) {
  double height = s->low[2] + half;
  for (size_t b = 1; b < s->wall_box_count; b++) {
    const struct isph_wall_box *wall = &s->wall_boxes[b];
    if (!rain_is_over(s, x, wall->low, wall->high) || wall->low[2] >= top) continue;
    if (wall->high[2] >= top) return INFINITY;
    height = fmax(height, wall->high[2] + half);
  }
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *soil = &s->scene->regions[k];
    double low[3], high[3];
    if (soil->type != REGION_POROUS) continue;
    for (int a = 0; a < 3; a++) {
      low[a] = soil->box[a] + s->soil_offset[k][a];
      high[a] = soil->box[a + 3] + s->soil_offset[k][a];
    }
    if (rain_is_over(s, x, low, high) && low[2] < top)
      height = fmax(height, fmin(high[2], top - half));
  }
  return height;
}

/* Finds x[2], where a drop that falls along x, y below `top` comes to rest: on the ground, or where
 * its distance from a particle is the mean of their sizes. Returns false if there is no room below
 * the top. */
static inline bool rain_find_resting_place(const struct isph *s, double top, double mass,
                                           double x[3]) {
  const double half = 0.5 * s->spacing;
  double size, height;
  x[2] = rain_ground_at(s, x, top, half);
  if (!isfinite(x[2])) return false;
  size = rain_size_at(s, x, mass), height = x[2];
  for (size_t i = 0; i < s->count; i++) {
    double across = 0;
    for (int a = 0; a < 2; a++) {
      double r = isph_uses_axis(s, a) ? s->position[i][a] - x[a] : 0;
      if (s->periodic[a]) r -= (s->high[a] - s->low[a]) * round(r / (s->high[a] - s->low[a]));
      across += r * r;
    }
    if (across >= s->support_max * s->support_max || s->position[i][2] > top) continue;
    const double apart = 0.5 * (size + rain_size_at(s, s->position[i], s->mass[i]));
    if (across < apart * apart)
      height = fmax(height, s->position[i][2] + sqrt(apart * apart - across));
  }
  x[2] = ranks_max(height);
  return x[2] + half <= top + 1e-6 * s->spacing;
}

static inline size_t isph_rain_things(const struct scene *scene) {
  size_t n = 0;
  for (size_t k = 0; k < scene->region_count; k++) n += scene->regions[k].type == REGION_RAIN;
  return n;
}

/* What is kept of a rain; in 2-D per m along y. */
enum {
  RAIN_FALLEN,  /* kg, as whole particles */
  RAIN_PENDING, /* kg, not yet fallen: less than one particle unless there is no room */
  RAIN_PLACES,  /* number of places tried so far, which is the number of the next */
  RAIN_NUMBERS
};

/* Adds the rain of the step to what is pending, and adds particles while that is the mass of one.
 */
static inline enum status isph_rain_fall(void *state, double dt) {
  static const double still[3] = {0};
  struct isph *s = state;
  const double mass = s->density * s->wall_volume * s->mass_ratio;
  double *rain = isph_own_numbers(s, "rain");
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    const struct time_table *table = &region->table;
    if (region->type != REGION_RAIN) continue;
    const double depth =
        table->count > 0 ? time_table_integral(table, s->time, s->time + dt, 0) : region->rate * dt;
    rain[RAIN_PENDING] += s->density * depth * isph_rain_area(s->scene, region);
    for (int tried = 0; rain[RAIN_PENDING] >= (1 - RAIN_ROUNDING) * mass && tried < RAIN_PLACES_MAX;
         tried++) {
      double x[3] = {0};
      rain_find_place(s, region, rain[RAIN_PLACES]++, x);
      if (!rain_find_resting_place(s, region->box[5], mass, x)) continue;
      enum status status = ranks_agree(isph_let_in(s, x, still, mass, 0));
      if (status != STATUS_OK) return status;
      rain[RAIN_PENDING] -= mass, rain[RAIN_FALLEN] += mass;
      tried = 0;
    }
    rain += RAIN_NUMBERS;
  }
  return STATUS_OK;
}

static inline void isph_rain_columns(struct history_columns *columns, const void *state) {
  const struct isph *s = state;
  const double *rain = isph_own_numbers(s, "rain");
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    if (region->type != REGION_RAIN) continue;
    history_number(columns, "kg", rain[RAIN_FALLEN] * s->thickness, "fallen_%s", region->name);
    history_number(columns, "kg", rain[RAIN_PENDING] * s->thickness, "pending_%s", region->name);
    rain += RAIN_NUMBERS;
  }
}

/* Whether there is a place without water at the top of a rain's box. */
static inline bool rain_has_room(const struct effect_context *context, const struct region *rain) {
  const struct lattice *l = context->lattice;
  const double *box = rain->box;
  size_t site = 0;
  for (size_t k = 0; k < l->size[2]; k++)
    for (size_t j = 0; j < l->size[1]; j++)
      for (size_t i = 0; i < l->size[0]; i++, site++) {
        const double x[3] = {l->origin[0] + (double)i * l->spacing[0],
                             l->origin[1] + (double)j * l->spacing[1],
                             l->origin[2] + (double)k * l->spacing[2]};
        if (l->kind[site] == SITE_EMPTY && x[0] > box[0] && x[0] < box[3] &&
            (l->dimensions == 2 || (x[1] > box[1] && x[1] < box[4])) && x[2] < box[5] &&
            x[2] > box[5] - 1.5 * l->spacing[2])
          return true;
      }
  return false;
}

/* The top of a rain's box must be free of walls, since rain falls from there. */
static inline enum status rain_check_top(const struct effect_context *context,
                                         const struct region *rain) {
  const struct scene *scene = context->scene;
  const double near = 1e-6 * context->spacing;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *wall = &scene->regions[k];
    bool covers = wall->type == REGION_WALL && wall->box[2] < rain->box[5] - near &&
                  wall->box[5] > rain->box[5] - near;
    for (int a = 0; a < 2; a++)
      covers = covers &&
               (!isph_scene_uses_axis(context, a) ||
                (wall->box[a] < rain->box[a + 3] - near && wall->box[a + 3] > rain->box[a] + near));
    if (covers)
      return FAIL(STATUS_INPUT,
                  "%s:%d: rain falls from the top of its box, at z = %g m, which the wall of line "
                  "%d covers in part; leave that part out, or let it begin elsewhere",
                  scene->path, rain->line, rain->box[5], wall->line);
  }
  return STATUS_OK;
}

static inline enum status isph_refuse_rain(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const double *g = scene->gravity, dx = context->spacing;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *rain = &scene->regions[k];
    if (rain->type != REGION_RAIN) continue;
    if (!(g[2] < 0) || scene->periodic[2])
      return FAIL(STATUS_INPUT,
                  "%s:%d: rain falls along -z onto what lies below: force.gravity has to point "
                  "there, and domain.periodic be false in z",
                  scene->path, rain->line);
    if (!context->has_surface)
      return FAIL(STATUS_INPUT,
                  "%s:%d: water fills the domain, so rain has no surface to fall on; leave room "
                  "above it",
                  scene->path, rain->line);
    const double fastest = RAIN_ROWS_MAX / 0.25 * sqrt(dx * -g[2]);
    if (rain->rate > fastest)
      return FAIL(STATUS_INPUT,
                  "%s:%d: rain of %g m/s comes faster than water falls out of its way, %g m/s at "
                  "this spacing; for a jet use an inflow region",
                  scene->path, rain->line, rain->rate, fastest);
    const double brings = scene_mean_given(scene, rain, rain->rate) * scene->end_time,
                 area = isph_rain_area(scene, rain);
    const double least = pow(dx, scene->dimensions);
    if (brings > 0 && brings * area < least)
      return FAIL(STATUS_INPUT,
                  "%s:%d: rain brings %g m of water by scene.end_time, on its area less than one "
                  "particle; use a domain.spacing below %.3g m or a longer scene.end_time",
                  scene->path, rain->line, brings, pow(brings * area, 1.0 / scene->dimensions));
    if (!rain_has_room(context, rain))
      return FAIL(STATUS_INPUT,
                  "%s:%d: rain falls from the top of its box, at z = %g m, and there is water all "
                  "over; let the box reach above the water",
                  scene->path, rain->line, rain->box[5]);
    const enum status status = rain_check_top(context, rain);
    if (status != STATUS_OK) return status;
  }
  return STATUS_OK;
}

static inline bool isph_rain_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->has_rain ? "rain regions" : "no rain region");
  return context->has_rain;
}

#endif

EFFECT(isph_rain, .model = "water of a given rate, in whole particles on what lies below",
       .citation = "docs/physics/isph.md", .wanted = isph_rain_wanted, .drives = true,
       .budget = 1u << BUDGET_ENTERED, .refuse = isph_refuse_rain, .numbers = "rain",
       .numbers_each = RAIN_NUMBERS, .things = isph_rain_things, .arrive = isph_rain_fall,
       .columns = isph_rain_columns)
