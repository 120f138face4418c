#include "sphsolve/isph/radiation.h"

#include "common/log.h"
#include "sphsolve/isph/own.h"

size_t isph_radiation_count(const struct scene *scene) {
  size_t n = 0;
  for (size_t k = 0; k < scene->region_count; k++) n += scene->regions[k].radiates;
  return n;
}

/* The numbers of a region that lets waves out. */
static double *numbers_of(const struct isph *s, const struct region *region) {
  double *numbers = isph_own_numbers(s, "radiation");
  for (const struct region *r = s->scene->regions; r < region; r++)
    if (r->radiates) numbers += RADIATION_NUMBERS;
  return numbers;
}

/* The depth of free water at a region's window by its given head, m; 0: there is none. */
static double depth_of(const struct isph *s, const struct region *region, double given) {
  double depth = 0;
  for (size_t k = 0; k < s->side_count; k++)
    if (s->sides[k].region == region && !(s->sides[k].porosity < 1))
      depth = fmax(depth, given - s->sides[k].low[2]);
  return depth;
}

double isph_radiation_head(const struct isph *s, const struct isph_open_side *side) {
  if (!side->region->radiates) return side->given;
  const double *numbers = numbers_of(s, side->region);
  const double depth = depth_of(s, side->region, side->given);
  if (!(depth > 0)) return side->given;
  return side->given - depth +
         isph_radiation_depth(depth, numbers[RADIATION_NOW] - numbers[RADIATION_MEAN],
                              -s->scene->gravity[2]);
}

/* The velocity outwards of the free water before a region's window, m/s: of each column by how much
 * water is there. */
static double outflow_of(const struct isph *s, const struct region *region) {
  double water = 0, flow = 0;
  for (size_t c = 0; c < s->column_count; c++) {
    const struct isph_column *column = &s->columns[c];
    const struct isph_open_side *side = &s->sides[column->side];
    if (side->region != region || side->porosity < 1 || column->dry) continue;
    const double weight = column->water * column->volume;
    water += weight, flow -= weight * column->speed;
  }
  return water > 0 ? flow / water : 0;
}

void isph_radiation_follow(struct isph *s, double dt) {
  const struct region *last = NULL; /* soil divides a window into several sides */
  for (size_t k = 0; k < s->side_count; k++) {
    const struct isph_open_side *side = &s->sides[k];
    if (!side->region->radiates || side->region == last) continue;
    double *numbers = numbers_of(s, last = side->region);
    const double length = s->high[side->axis] - s->low[side->axis];
    const double depth = depth_of(s, last, side->given);
    const double period = 4 * length / sqrt(-s->scene->gravity[2] * depth);
    const double now = outflow_of(s, last);
    numbers[RADIATION_NOW] = now;
    if (numbers[RADIATION_FAST] == 0 && now > sqrt(-s->scene->gravity[2] * depth)) {
      numbers[RADIATION_FAST] = 1;
      log_warning(
          "%s:%d: t = %.4g s: %.3g m/s leave by this side, faster than waves come against "
          "it, so that radiates does not hold its head; where that lasts, leave the key out",
          s->scene->path, last->line, s->time, now);
    }
    if (s->step == 0) numbers[RADIATION_MEAN] = now;
    numbers[RADIATION_MEAN] -= expm1(-dt / period) * (now - numbers[RADIATION_MEAN]);
  }
}
