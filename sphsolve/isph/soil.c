#include "sphsolve/isph/soil.h"

#include <math.h>
#include <string.h>

#include "common/kernel.h"
#include "sphsolve/isph/effects/porosity.h"
#include "sphsolve/isph/interface.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/speed_forecast.h"

/* Soil is a property of space: eps = 1 - sum (1 - eps0) s, with s the fraction of soil in a kernel
 * half as wide as that of the water in the least porous soil (M15 section 4 with soil markers in
 * the limit of many; for a box the kernel sum is a known integral). Volumes and supports change
 * with eps: the particles' sums do not resolve an edge that is steeper than their spacing in the
 * soil. All soils have the same width, so that their fractions add up to 1 where they touch. Boxes
 * that touch a closed side extend beyond it, so that walls see no thinner soil.
 *
 * Where links carry the flux across edges (isph/link.h), a particle's own drag acts along them
 * only. Smoothed as widely as the porosity it would hold back water beside the soil, so it is
 * averaged over about one spacing: a kernel with a smoothing length of half a spacing has the
 * variance of such a mean. */
#define DRAG_SMOOTHING 0.5

struct isph_soil_place isph_soil_place(const struct isph *s, size_t k, double ahead) {
  const struct region *region = &s->scene->regions[k];
  double near = 1e-6 * s->spacing;
  struct isph_soil_place place = {.period = {0}};
  for (int a = 0; a < 3; a++) {
    double low = region->box[a], high = region->box[a + 3];
    bool open_low = low <= s->low[a] + near, open_high = high >= s->high[a] - near;
    /* Soil that moves away from a side leaves water behind it. */
    open_low = open_low && !(region->soil_velocity[a] > 0 && !s->periodic[a]);
    open_high = open_high && !(region->soil_velocity[a] < 0 && !s->periodic[a]);
    if (s->dimensions == 2 && a == 1) open_low = open_high = true;
    if (s->periodic[a] && !(open_low && open_high)) {
      place.period[a] = s->high[a] - s->low[a], place.middle[a] = 0.5 * (low + high);
      open_low = open_high = false;
    }
    place.low[a] = open_low ? -INFINITY : low, place.high[a] = open_high ? INFINITY : high;
    place.offset[a] = s->soil_offset[k][a] + ahead * region->soil_velocity[a];
  }
  return place;
}

struct isph_box isph_soil_image(const struct isph_soil_place *place, const double x[3]) {
  struct isph_box box;
  for (int a = 0; a < 3; a++) {
    double offset = place->offset[a], period = place->period[a];
    if (period > 0) offset += period * round((x[a] - place->middle[a] - offset) / period);
    box.low[a] = place->low[a] + offset, box.high[a] = place->high[a] + offset;
  }
  return box;
}

bool isph_box_clip(const struct isph_box *box, const double x[3], const double step[3],
                   double *from, double *to) {
  for (int a = 0; a < 3; a++) {
    const double low = box->low[a] - x[a], high = box->high[a] - x[a];
    if (low == -INFINITY && high == INFINITY) continue;
    if (step[a] == 0) {
      if (low > 0 || high <= 0) return false;
      continue;
    }
    const double enters = (step[a] > 0 ? low : high) / step[a];
    const double leaves = (step[a] > 0 ? high : low) / step[a];
    if (enters > *from) *from = enters;
    if (leaves < *to) *to = leaves;
  }
  return *from < *to;
}

struct isph_box isph_soil_box(const struct isph *s, size_t k, double ahead, const double x[3]) {
  const struct isph_soil_place place = isph_soil_place(s, k, ahead);
  return isph_soil_image(&place, x);
}

bool isph_soil_is_far(const struct isph *s, const double box[6], size_t k, double reach,
                      const double x[3]) {
  const double near = 1e-3 * s->spacing;
  for (int a = 0; a < 3; a++) {
    if (!isph_uses_axis(s, a)) continue;
    const double y = x[a] - s->soil_offset[k][a];
    if (s->periodic[a]) {
      const double length = s->high[a] - s->low[a], away = y - 0.5 * (box[a] + box[a + 3]);
      const double most = 0.5 * (box[a + 3] - box[a]) + reach + near;
      if (fabs(away - length * round(away / length)) > most) return true;
      continue;
    }
    if (box[a] > s->low[a] + near && y < box[a] - reach - near) return true;
    if (box[a + 3] < s->high[a] - near && y > box[a + 3] + reach + near) return true;
  }
  return false;
}

static double smoothing_of(const struct isph *s) {
  double spread = pow(s->soil_porosity_least, -1.0 / s->dimensions);
  return 0.25 * s->scene->isph.support_ratio * s->spacing * spread;
}

static struct isph_fraction fraction_of_box(const struct isph *s, const struct isph_box *box,
                                            const double x[3], double h) {
  double part[3], first[3], second[3];
  struct isph_fraction fraction = {.value = 1};
  for (int a = 0; a < 3; a++) {
    double from = x[a] - box->low[a], to = x[a] - box->high[a];
    part[a] = kernel_integral(from / h) - kernel_integral(to / h);
    fraction.value *= part[a];
    if (!s->on.interfaces) continue;
    first[a] = kernel_w(KERNEL_CUBIC, 1, fabs(from), h) - kernel_w(KERNEL_CUBIC, 1, fabs(to), h);
    second[a] = copysign(kernel_dw(KERNEL_CUBIC, 1, fabs(from), h), from) -
                copysign(kernel_dw(KERNEL_CUBIC, 1, fabs(to), h), to);
  }
  if (!s->on.interfaces) return fraction;
  for (int a = 0; a < 3; a++) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    /* components aa and bc of the Hessian */
    static const int own[3] = {0, 3, 5}, other[3] = {4, 2, 1};
    fraction.gradient[a] = first[a] * part[b] * part[c];
    fraction.hessian[own[a]] = second[a] * part[b] * part[c];
    fraction.hessian[other[a]] = part[a] * first[b] * first[c];
  }
  return fraction;
}

/* Fraction of the part of `box` that no soil from region `next` on occupies: S(box) - S(box and
 * next). `next` belongs to another polygon than the box. */
static struct isph_fraction fraction_left(const struct isph *s, const struct isph_box *box,
                                          size_t next, double ahead, const double x[3], double h) {
  for (; next < s->scene->region_count; next++) {
    const struct region *region = &s->scene->regions[next];
    if (region->type != REGION_POROUS) continue;
    if (region->is_part && isph_soil_is_far(s, region->box, next, 2 * h, x)) continue;
    struct isph_box both = isph_soil_box(s, next, ahead, x);
    bool overlap = true;
    for (int a = 0; a < 3; a++) {
      both.low[a] = fmax(both.low[a], box->low[a]), both.high[a] = fmin(both.high[a], box->high[a]);
      overlap = overlap && both.low[a] < both.high[a];
    }
    if (overlap) {
      struct isph_fraction all = fraction_left(s, box, next + 1, ahead, x, h),
                           taken = fraction_left(s, &both, region->end, ahead, x, h);
      isph_fraction_add(&all, -1, &taken);
      return all;
    }
  }
  return fraction_of_box(s, box, x, h);
}

/* Most boxes of walls near a place; beyond that they count as open. */
#define WALLS_NEAR 256

/* Boxes that do not overlap. */
struct disjoint {
  size_t count;
  struct isph_box box[WALLS_NEAR];
};

static bool intersect(const struct isph_box *p, const struct isph_box *q, struct isph_box *both) {
  bool any = true;
  for (int a = 0; a < 3; a++) {
    both->low[a] = fmax(p->low[a], q->low[a]), both->high[a] = fmin(p->high[a], q->high[a]);
    any = any && both->low[a] < both->high[a];
  }
  return any;
}

/* Adds the part of a box that is in none of the boxes from number n on. */
static void add_part(struct disjoint *boxes, size_t n, size_t end, struct isph_box part) {
  struct isph_box both;
  while (n < end && !intersect(&part, &boxes->box[n], &both)) n++;
  if (n == end && boxes->count < WALLS_NEAR) boxes->box[boxes->count++] = part;
  for (int a = 0; a < 3 && n < end; a++) {
    struct isph_box beside = part;
    beside.high[a] = part.low[a] = both.low[a];
    if (beside.low[a] < beside.high[a]) add_part(boxes, n + 1, end, beside);
    beside = part;
    beside.low[a] = part.high[a] = both.high[a];
    if (beside.low[a] < beside.high[a]) add_part(boxes, n + 1, end, beside);
  }
}

/* Finds the walls at rest within 2 h of x. */
static void find_walls(const struct isph *s, const double x[3], double h, struct disjoint *walls) {
  const struct region *regions = s->scene->regions;
  walls->count = 0;
  for (size_t k = 0; k < s->scene->region_count && s->wall_box_count > 1; k++) {
    if (regions[k].type != REGION_WALL) continue;
    const bool begins = k == regions[k].first && regions[k].end > k + 1;
    if (begins && isph_soil_is_far(s, regions[k].extent, k, 2 * h, x)) k = regions[k].end - 1;
    if (isph_soil_is_far(s, regions[k].box, k, 2 * h, x)) continue;
    if (isph_region_speed(s->scene, &regions[k]) > 0) continue;
    add_part(walls, 0, walls->count, isph_soil_box(s, k, 0, x));
  }
}

/* Least part of the kernel outside of walls. */
#define OPEN_LEAST 1e-2

/* The part of the kernel at x that is outside of walls. Fractions of soil are shares of this part:
 * a wall that ends at a soil, or lies in it, does not thin it. If there is hardly any, walls are
 * left out. */
static double open_part(const struct isph *s, const double x[3], double h, struct disjoint *walls) {
  double open = 1;
  find_walls(s, x, h, walls);
  for (size_t k = 0; k < walls->count; k++) open -= fraction_of_box(s, &walls->box[k], x, h).value;
  if (open > OPEN_LEAST) return open;
  walls->count = 0;
  return 1;
}

/* Porosity functions of M15 eqs. 9c and 9d, without the factors alpha nu / D50^2 and beta / D50. */
static double linear_of(double eps) {
  return (1 - eps) * (1 - eps) / (eps * eps * eps);
}
static double forchheimer_of(double eps) {
  return (1 - eps) / (eps * eps * eps);
}

struct isph_material isph_material_of(const struct isph *s, const struct region *region) {
  const double eps = region->porosity, d = region->grain_size;
  const double scale = s->scene->isph.form == FORM_M15 ? eps : 1; /* 1/G */
  return (struct isph_material){.porosity = eps,
                                .inertia = scale * inertia_coefficient(eps) / eps,
                                .a = scale * region->alpha * s->kinematic_viscosity / (d * d) *
                                     linear_of(eps),
                                .b = scale * region->beta / d * forchheimer_of(eps)};
}

/* Finds the soil at a place, smoothed by a kernel of smoothing length h. */
static void soil_smoothed(const struct isph *s, const double position[3], double ahead, double h,
                          struct soil_point *soil) {
  const struct scene *scene = s->scene;
  const bool over_eps = scene->isph.form == FORM_M15;
  double solid = 0, share = 0, a = 0, b = 0, inertia = 0, velocity[3] = {0}, paper = 1;
  struct isph_soil_mix mix = ISPH_SOIL_MIX;
  struct disjoint walls;
  const double open = open_part(s, position, h, &walls);
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    if (region->type != REGION_POROUS) continue;
    if (region->is_part) {
      if (k == region->first && isph_soil_is_far(s, region->extent, k, 2 * h, position))
        k = region->end - 1;
      if (isph_soil_is_far(s, scene->regions[k].box, k, 2 * h, position)) continue;
    }
    struct isph_box box = isph_soil_box(s, k, ahead, position);
    if (fraction_of_box(s, &box, position, h).value <= 0) continue;
    /* A later soil replaces an earlier one. */
    struct isph_fraction left = fraction_left(s, &box, region->end, ahead, position, h);
    for (size_t n = 0; n < walls.count; n++) {
      struct isph_box both;
      if (!intersect(&box, &walls.box[n], &both)) continue;
      const struct isph_fraction taken = fraction_left(s, &both, region->end, ahead, position, h);
      isph_fraction_add(&left, -1, &taken);
    }
    const double w = left.value / open;
    if (w <= 0) continue;
    const struct isph_material own = isph_material_of(s, region);
    solid += w * (1 - region->porosity);
    share += w;
    a += w * own.a;
    b += w * own.b;
    if (s->on.interfaces) isph_soil_mix_add(&mix, &left, own.a, own.b);
    inertia += w * own.inertia;
    for (int c = 0; c < 3; c++) velocity[c] += w * region->soil_velocity[c];
    paper = fmin(paper, fmax(fmin(1, 2 - 2 * w), region->porosity)); /* M15 eq. 32 */
  }
  double eps = scene->isph.porosity_paper ? paper : 1 - solid;
  double weight = share > 0 ? 1 / share : 0, own = 1 - solid * weight;
  soil->porosity = eps;
  soil->fraction = share;
  /* Inertia and drag, as multiples of the pressure gradient, are weighted by the fraction of their
   * soil: a layer then has the same inertia and head loss as with sharp faces, next to free water
   * and to another soil. Those at the smoothed porosity, which M15 uses, are steeper than linear in
   * the fraction: too small for the forces over rho_w, and the drag too large for M15's forces over
   * eps. */
  soil->a = a, soil->b = b, soil->inertia = 1 - share + inertia;
  if (scene->isph.porosity_paper && own < 1) {
    double scale = over_eps ? eps / own : 1;
    soil->a = a * weight * scale * linear_of(eps) / linear_of(own);
    soil->b = b * weight * scale * forchheimer_of(eps) / forchheimer_of(own);
    soil->inertia = inertia_coefficient(eps) / (over_eps ? 1 : eps);
  }
  memset(soil->normal, 0, sizeof soil->normal);
  if (s->on.interfaces) isph_soil_mix_split(&mix, h, soil);
  for (int c = 0; c < 3; c++) soil->velocity[c] = velocity[c] * weight;
}

void isph_soil_at(const struct isph *s, const double position[3], double ahead,
                  struct soil_point *soil) {
  struct soil_point near;
  soil_smoothed(s, position, ahead, smoothing_of(s), soil);
  if (!s->on.links) return;
  soil_smoothed(s, position, ahead, DRAG_SMOOTHING * s->spacing, &near);
  soil->a = near.a, soil->b = near.b;
  if (!s->on.interfaces) return;
  soil->along_a = near.along_a, soil->along_b = near.along_b, soil->plane = near.plane;
  memcpy(soil->normal, near.normal, sizeof near.normal);
}

double isph_soil_minimum(const struct scene *scene) {
  double least = 1;
  for (size_t k = 0; k < scene->region_count; k++)
    if (scene->regions[k].type == REGION_POROUS) least = fmin(least, scene->regions[k].porosity);
  return least;
}

/* Whether the scene has two soils whose drag differs. */
bool isph_soils_differ(const struct scene *scene) {
  const struct region *first = NULL;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *r = &scene->regions[k];
    if (r->type != REGION_POROUS) continue;
    if (first == NULL) first = r;
    const bool differs = r->porosity != first->porosity || r->grain_size != first->grain_size ||
                         r->alpha != first->alpha || r->beta != first->beta;
    if (differs) return !scene->isph.porosity_paper;
  }
  return false;
}
