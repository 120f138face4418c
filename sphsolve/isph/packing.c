#include "sphsolve/isph/packing.h"

#include <math.h>

#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/vector.h"
#include "sphsolve/isph/constants.h"

/* Least cosine between the force and an axis for a side of a region to be level. */
#define LEVEL_AXIS (1 - 1e-6)
/* Distance over which the arrangement is forgotten, in sizes of a particle. */
#define FADES_WITHIN 0.25

static bool contains(const struct isph *s, const struct region *region, const double x[3]) {
  bool inside = true;
  for (int a = 0; a < 3; a++)
    if (isph_uses_axis(s, a)) inside = inside && x[a] > region->box[a] && x[a] < region->box[a + 3];
  return inside;
}

/* Whether a place is within water or behind a wall; if so and `top` is not NULL, sets it to where
 * the water ends along the axis `up`: the upper side of its region, or the lower of a region that
 * takes the water away above. */
static bool is_filled(const struct isph *s, const double x[3], int up, double sign, double *top) {
  bool filled = false;
  double at[3];
  for (int a = 0; a < 3; a++) {
    const double length = s->high[a] - s->low[a];
    const bool inside = !isph_uses_axis(s, a) || (x[a] >= s->low[a] && x[a] <= s->high[a]);
    if (!inside && !s->periodic[a]) return true;
    at[a] = inside ? x[a] : x[a] < s->low[a] ? x[a] + length : x[a] - length;
  }
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    const bool water =
        region->type == REGION_WATER || (region->type == REGION_POROUS && region->saturated);
    const bool takes = region->type == REGION_EMPTY;
    if (!(water || takes || region->type == REGION_WALL) || !contains(s, region, at)) continue;
    filled = !takes;
    if (top != NULL && water) *top = region->box[sign > 0 ? up + 3 : up];
  }
  return filled;
}

/* The depth of particle i, of that size, under a level top of the water; INFINITY where there is
 * none: the water ends beside it, or farther above. */
static double depth_of(const struct isph *s, size_t i, double size) {
  const double *f = s->force, *x = s->position[i];
  double top = NAN;
  int up = 0;
  for (int a = 1; a < 3; a++)
    if (fabs(f[a]) > fabs(f[up])) up = a;
  if (!(fabs(f[up]) > LEVEL_AXIS * sqrt(dot(f, f)))) return INFINITY;
  const double sign = f[up] < 0 ? 1 : -1;
  for (int a = 0; a < 3; a++)
    for (int side = -1; side < 2 && isph_uses_axis(s, a) && a != up; side += 2) {
      double beside[3] = {x[0], x[1], x[2]};
      beside[a] += side * size;
      if (!is_filled(s, beside, up, sign, NULL)) return INFINITY;
    }
  double above[3] = {x[0], x[1], x[2]};
  above[up] += sign * size;
  if (!is_filled(s, x, up, sign, &top) || is_filled(s, above, up, sign, NULL)) return INFINITY;
  return sign * (top - x[up]);
}

/* Whether all places around particle i, at the distance of its size, are within water or behind a
 * wall. */
static bool is_inside(const struct isph *s, size_t i) {
  const double *x = s->position[i];
  bool inside = true;
  for (int a = 0; a < 3; a++)
    for (int side = -1; side < 2 && isph_uses_axis(s, a); side += 2) {
      double beside[3] = {x[0], x[1], x[2]};
      beside[a] += side * s->size[i];
      inside = inside && is_filled(s, beside, a, 1, NULL);
    }
  return inside;
}

/* Whether particle i or a neighbour is on a surface that is not a level top: there water is lacking
 * and is to come. */
static bool is_beside_void(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                           const double *depth) {
  if (s->surface[i] > 0) return !isfinite(depth[i]);
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const size_t j = chunk->pair[p] & PAIR_MASK;
    if (s->surface[j] > 0 && !isfinite(depth[j])) return true;
  }
  return false;
}

void isph_packing_begin(struct isph *s) {
  const double *f = s->force, force = sqrt(dot(f, f));
  double top = -INFINITY, *depth = s->work[0]; /* INFINITY: not on a level top */
  for (size_t i = 0; i < s->count; i++) {
    const double size = s->size[i];
    s->submerged[i] = s->surface[i] > 0 && is_inside(s, i) ? (float)s->surface[i] : 0;
    if (s->submerged[i] > 0) s->surface[i] = 0;
    depth[i] = s->surface[i] > 0 && force > 0 ? depth_of(s, i, size) / size : INFINITY;
  }
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double *m = s->gradient_sum[i], up = force > 0 ? -dot(m, f) / force : 0;
      const double uneven = s->kernel_sum[i] - 1, size = s->size[i];
      const bool level = isfinite(depth[i]);
      s->packing[i][0] = is_beside_void(s, &s->chunks[c], i, depth) ? 0 : (float)uneven;
      for (int a = 0; a < 3; a++)
        s->packing[i][1 + a] = level ? (float)(m[a] + up * f[a] / force) : 0;
      s->packing[i][4] = level ? (float)(2 * depth[i] - 1) : 0;
      s->packing[i][5] = level ? 1 : 0;
      const double to_top = s->surface[i] > 0 ? isph_packing_depth(s, i, size) : 0;
      top = fmax(top, force * to_top - dot(f, s->position[i]));
    }
  top = ranks_max(top);
  for (size_t i = s->local.begin; i < s->local.end; i++)
    s->pressure[i] = s->density * (top + dot(f, s->position[i]));
}

void isph_packing_fade(struct isph *s, size_t i, const double step[3]) {
  const double left = exp(-sqrt(dot(step, step)) / (FADES_WITHIN * s->size[i]));
  for (int k = 0; k < 6; k++) s->packing[i][k] *= (float)left;
  s->submerged[i] *= (float)left;
}
