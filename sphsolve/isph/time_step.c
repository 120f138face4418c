#include "sphsolve/isph/time_step.h"

#include <math.h>

#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/speed_forecast.h"
#include "sphsolve/isph/wall.h"
#include "sphsolve/isph/constants.h"

static double length(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* The largest prescribed velocity, m/s: that which will set the water in motion if it is still at
 * rest. */
static double fastest_drive(const struct isph *s) {
  double fastest = 0;
  for (size_t b = 1; b < s->wall_box_count; b++)
    if (isph_wall_is_inside(s, &s->wall_boxes[b]))
      fastest = fmax(fastest, length(s->wall_boxes[b].region->velocity));
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *r = &s->scene->regions[k];
    if (r->type != REGION_WALL && r->type != REGION_WATER && r->type != REGION_RAIN)
      fastest = fmax(fastest, isph_region_speed(s->scene, r));
  }
  return fastest;
}

/* The velocity of the fastest particle, m/s. */
static double fastest_water(const struct isph *s) {
  double fastest = 0;
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    double eps = s->on.soil ? s->porosity[i] : 1;
    fastest = fmax(fastest, length(s->velocity[i]) / eps);
  }
  return ranks_max(fastest);
}

double isph_first_dt(const struct isph *s, double dt) {
  const double way = fastest_water(s) * dt;
  return way > s->spacing ? dt * sqrt(DT_ADVECTION_SURFACE * s->spacing / way) : INFINITY;
}

double isph_stable_dt(const struct isph *s, const char **limited_by) {
  const double fastest = fmax(fastest_drive(s), fastest_water(s));
  const double force = fmax(length(s->force), isph_head_drive(s->scene));
  const struct {
    const char *name;
    double dt;
  } limits[] = {
      {"advection",
       (s->on.surface ? DT_ADVECTION_SURFACE : DT_ADVECTION) * s->spacing / fmax(fastest, 1e-30)},
      {"force", force > 0 ? 0.25 * sqrt(s->spacing / force) : INFINITY},
      {s->on.dt_most_by, s->on.dt_most},
  };
  double least = limits[0].dt;
  *limited_by = limits[0].name;
  for (size_t k = 1; k < sizeof limits / sizeof *limits; k++)
    if (limits[k].dt < least) least = limits[k].dt, *limited_by = limits[k].name;
  for (size_t k = 0; k < s->on.active_count; k++) {
    const struct effect *effect = s->on.active[k];
    const double dt = effect->stable_dt != NULL ? effect->stable_dt(s) : INFINITY;
    if (dt < least) least = dt, *limited_by = effect->name;
  }
  return least;
}

#define END_STEPS 32 /* with so many steps left or fewer, their lengths are planned */

/* Solves rho + rho^2 + .. + rho^n = sum for rho, 0 < sum <= n, by Newton's method from above. */
static double ratio_of(int n, double sum) {
  double rho = 1;
  for (int round = 0; round < 60; round++) {
    double value = 0, slope = 0;
    for (int k = 0; k < n; k++) slope = slope * rho + value + 1, value = (value + 1) * rho;
    const double next = rho - (value - sum) / slope;
    if (!(next < rho * (1 - 1e-15))) break;
    rho = next;
  }
  return rho;
}

static int steps_of(double left, double dt) {
  return (int)fmax(1, ceil(left / dt * (1 - 1e-6)));
}

/* A step leaves a divergence in proportion to its dt, which the pressure of the next step divides
 * by its own dt: after a step of dt, one of dt/2 reads twice the pressure that moves the water, and
 * a very short one amplifies rounding. So the last n steps shrink by a constant ratio and add up to
 * the remaining time. If the limit falls faster than that, n grows by an eighth, early and then
 * seldom. */
double isph_dt_to_end(struct isph_ending *ending, double left, double limit) {
  double last = ending->last > 0 ? ending->last : limit, ratio;
  int steps = ending->steps - 1;
  *ending = (struct isph_ending){.last = limit};
  if (left / limit > END_STEPS) return limit;
  const int fewest = steps_of(left, limit);
  if (steps < 1 && fewest > 1 && limit * fewest <= left * (1 + 1e-6)) return limit;
  if (limit < END_FALL * last) {
    last = limit;
    if (steps < fewest + fewest / 8) steps = fewest + fewest / 8;
  }
  /* not planned yet, or the end has changed */
  if (steps < steps_of(left, last)) steps = steps_of(left, last);
  while (ratio = ratio_of(steps, left / last), last * ratio > limit * (1 + 1e-6))
    steps += 1 + steps / 8;
  *ending = (struct isph_ending){.last = steps == 1 ? left : last * ratio, .steps = steps};
  return ending->last;
}
