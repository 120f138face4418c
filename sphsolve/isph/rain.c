/* Rain comes in whole particles, each with the mass of all others. What falls on the area of a
 * region is accumulated as mass; once it is that of a particle, one is placed where a drop falling
 * there would come to rest. So the water of any rate over any time is correct to less than one
 * particle, also if it is less than a row. The drop has no velocity, and brings no momentum.
 *
 * The places follow each other by the golden ratio (in 3-D by the two numbers that replace it:
 * Roberts 2018, "The unreasonable effectiveness of quasirandom sequences"): any section of the
 * sequence covers the area evenly, and a run resumed from a checkpoint continues it.
 *
 * A source div v = q in the particles at the surface instead, as wells have a sink, would lift the
 * surface twice: by spreading its particles, and by the particle that is added. In a well, the
 * particle that is removed is the one that its sink has compressed. */
#include "sphsolve/isph/rain.h"

#include <math.h>

#include "common/memory.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/particles.h"
#include "sphsolve/isph/soil.h"

/* Most places tried in a step for a drop that finds no room. */
#define PLACES_MAX 64
/* Share of a particle's mass that the sum over steps may lack by rounding. */
#define ROUNDING 1e-9

double isph_rain_area(const struct scene *scene, const struct region *rain) {
  const double *b = rain->box;
  return (b[3] - b[0]) * (scene->dimensions == 3 ? b[4] - b[1] : 1);
}

enum status isph_rain_create(struct isph *s) {
  const struct scene *scene = s->scene;
  size_t n = 0;
  for (size_t k = 0; k < scene->region_count; k++) n += scene->regions[k].type == REGION_RAIN;
  enum status status = memory_allocate(&s->rains, n, sizeof *s->rains, "rain");
  if (status != STATUS_OK) return status;
  for (size_t k = 0; k < scene->region_count; k++)
    if (scene->regions[k].type == REGION_RAIN)
      s->rains[s->rain_count++].region = &scene->regions[k];
  return STATUS_OK;
}

/* x and y of place number n of a rain. */
static void find_place(const struct isph *s, const struct region *rain, double n, double x[3]) {
  static const double steps[2][2] = {{0.6180339887498949, 0},
                                     {0.7548776662466927, 0.5698402909980532}};
  for (int a = 0; a < 2; a++) {
    const double step = steps[s->dimensions == 3][a], at = 0.5 + n * step;
    x[a] = rain->box[a] + (at - floor(at)) * (rain->box[a + 3] - rain->box[a]);
  }
}

static bool is_over(const struct isph *s, const double x[3], const double low[3],
                    const double high[3]) {
  for (int a = 0; a < 2; a++)
    if (isph_uses_axis(s, a) && !(x[a] >= low[a] && x[a] < high[a])) return false;
  return true;
}

/* Size at x of a particle of this mass: the side of its bulk volume. */
static double size_at(const struct isph *s, const double x[3], double mass) {
  struct soil_point soil = {.porosity = 1};
  if (s->on.soil) isph_soil_at(s, x, 0, &soil);
  return isph_size_of(s, mass / (soil.porosity * s->density));
}

/* Height at which a drop of half size `half` rests on the ground below `top` at x: on the highest
 * wall, at the face of the highest soil, or on the domain's floor. INFINITY if a wall covers the
 * top. */
static double ground_at(const struct isph *s, const double x[3], double top, double half) {
  double height = s->low[2] + half;
  for (size_t b = 1; b < s->wall_box_count; b++) {
    const struct isph_wall_box *wall = &s->wall_boxes[b];
    if (!is_over(s, x, wall->low, wall->high) || wall->low[2] >= top) continue;
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
    if (is_over(s, x, low, high) && low[2] < top) height = fmax(height, fmin(high[2], top - half));
  }
  return height;
}

/* Finds x[2], where a drop that falls along x, y below `top` comes to rest: on the ground, or where
 * its distance from a particle is the mean of their sizes. Returns false if there is no room below
 * the top. */
static bool find_resting_place(const struct isph *s, double top, double mass, double x[3]) {
  const double half = 0.5 * s->spacing;
  double size, height;
  x[2] = ground_at(s, x, top, half);
  if (!isfinite(x[2])) return false;
  size = size_at(s, x, mass), height = x[2];
  for (size_t i = 0; i < s->count; i++) {
    double across = 0;
    for (int a = 0; a < 2; a++) {
      double r = isph_uses_axis(s, a) ? s->position[i][a] - x[a] : 0;
      if (s->periodic[a]) r -= (s->high[a] - s->low[a]) * round(r / (s->high[a] - s->low[a]));
      across += r * r;
    }
    if (across >= s->support_max * s->support_max || s->position[i][2] > top) continue;
    const double apart = 0.5 * (size + size_at(s, s->position[i], s->mass[i]));
    if (across < apart * apart)
      height = fmax(height, s->position[i][2] + sqrt(apart * apart - across));
  }
  x[2] = ranks_max(height);
  return x[2] + half <= top + 1e-6 * s->spacing;
}

enum status isph_rain_fall(struct isph *s, double dt) {
  static const double still[3] = {0};
  const double mass = s->density * s->wall_volume * s->mass_ratio;
  for (size_t k = 0; k < s->rain_count; k++) {
    struct isph_rain *rain = &s->rains[k];
    const struct region *region = rain->region;
    const struct time_table *table = &region->table;
    const double depth =
        table->count > 0 ? time_table_integral(table, s->time, s->time + dt, 0) : region->rate * dt;
    rain->pending += s->density * depth * isph_rain_area(s->scene, region);
    for (int tried = 0; rain->pending >= (1 - ROUNDING) * mass && tried < PLACES_MAX; tried++) {
      double x[3] = {0};
      find_place(s, region, rain->places++, x);
      if (!find_resting_place(s, region->box[5], mass, x)) continue;
      enum status status = ranks_agree(isph_let_in(s, x, still, mass, 0));
      if (status != STATUS_OK) return status;
      rain->pending -= mass, rain->fallen += mass;
      tried = 0;
    }
  }
  return STATUS_OK;
}
