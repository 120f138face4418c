#include "ct2model/surface/surfels.h"

#include <math.h>
#include <stdbool.h>

#include "common/variants.h"
#include "ct2model/surface/phase_bits.h"

enum { BLOCK = SURFELS_BLOCK, LANES = SURFELS_LANES };
/* The search is one function for each instruction set. */
#define INLINE __attribute__((always_inline)) static inline

/* Squared distance to the nearest of n discs; `point` from the first cell's first corner. Squares
 * are compared by their bits, which for positive floats rise with the value. */
INLINE float nearest_disc(const uint32_t *restrict places, const uint32_t *restrict normals, int n,
                          const float point[3], const float stretch[3]) {
  const float x0 = point[0], y0 = point[1], z0 = point[2], radius = (float)SURFELS_RADIUS;
  const float sx = stretch[0] / 255.0f, sy = stretch[1] / 255.0f, sz = stretch[2] / 255.0f;
  union {
    float value;
    int32_t bits;
  } least = {INFINITY};
  const int end = (n + LANES - 1) / LANES * LANES;
  for (int i = 0; i < end; i++) {
    const uint32_t place = places[i], normal = normals[i];
    const float x = x0 - sx * (float)(int)(place & 1023u);
    const float y = y0 - sy * (float)(int)(place >> 10 & 1023u);
    const float z = z0 - sz * (float)(int)(place >> 20 & 1023u);
    const float height =
        (x * (float)((int)(normal << 24) >> 24) + y * (float)((int)(normal << 16) >> 24) +
         z * (float)((int)(normal << 8) >> 24)) *
        (1.0f / 127.0f);
    const float aside = x * x + y * y + z * z - height * height;
    const float over = sqrtf(aside > 0.0f ? aside : 0.0f) - radius;
    const float beyond = over > 0.0f ? over : 0.0f;
    union {
      float value;
      int32_t bits;
    } square = {height * height + beyond * beyond};
    /* Lanes behind the last are INT32_MAX, said without a condition: one would split the loop and
     * leave half of the discs to its rest. */
    /* cppcheck-suppress shiftTooManyBitsSigned ; gcc and clang shift the sign in, as above */
    const int32_t bits = square.bits | (int32_t)((uint32_t)((n - 1 - i) >> 31) >> 1);
    least.bits = bits < least.bits ? bits : least.bits;
  }
  return least.value;
}

/* The search for the disc nearest to a point. */
struct search {
  const struct surfels *surfels;
  double point[3], best;
  double cell[3]; /* the point in cells from the first one */
  float stretch[4];
  size_t near; /* the block of the best */
};

INLINE void look_at(struct search *search, size_t block, const size_t at[3]) {
  const struct surfels *surfels = search->surfels;
  const uint32_t first = surfels->first[block], end = surfels->first[block + 1];
  float local[3];
  for (int d = 0; d < 3; d++)
    local[d] = (float)(search->point[d] - ((double)(at[d] * BLOCK) + 0.5) * surfels->stretch[d]);
  const float square = nearest_disc(surfels->items + first, surfels->items + surfels->pitch + first,
                                    (int)(end - first), local, search->stretch);
  if (!((double)square < search->best * search->best)) return;
  search->best = sqrt((double)square);
  search->near = block;
}

/* No disc reaches farther from its block; a little more than its radius for rounding. */
INLINE double bound_of(const struct search *search) {
  return search->best + SURFELS_RADIUS + 1e-3;
}

/* From `at`, in cells, to the interval low .. high. */
INLINE double gap_of(double at, double low, double high, double stretch) {
  const double below = low - at, above = at - high, gap = below > above ? below : above;
  return gap > 0.0 ? gap * stretch : 0.0;
}

/* Square of the distance from a point, in cells from one before the block's first, to its box. */
INLINE float box_gap(const struct surfel_box *box, const float at[4], const float stretch[4]) {
  float sum = 0.0f, gap[4];
  for (int d = 0; d < 4; d++) {
    const float below = (float)box->low[d] * (1.0f / SURFELS_PARTS) - at[d];
    const float above = at[d] - (float)box->high[d] * (1.0f / SURFELS_PARTS);
    const float out = below > above ? below : above;
    gap[d] = (out > 0.0f ? out : 0.0f) * stretch[d];
  }
  for (int d = 0; d < 4; d++) sum += gap[d] * gap[d];
  return sum;
}

/* A normal is rounded to three times 1/127, so that the height over a disc may come out by 0.68 %
 * too small: no disc of a box so far away is nearer than the best. */
INLINE float box_bound(const struct search *search) {
  const double bound = 1.00695 * (search->best + 1e-3);
  return (float)(bound * bound);
}

/* The blocks of a row from `low` to `high` in which a disc may be nearer. */
INLINE void look_along(struct search *search, long y, long z, long low, long high) {
  const struct surfels *surfels = search->surfels;
  const size_t row = (size_t)z * surfels->blocks[1] + (size_t)y;
  for (long w = low / PHASE_WORD; w <= high / PHASE_WORD; w++) {
    uint64_t open = surfels->occupied[row * surfels->words + (size_t)w];
    if (low > w * PHASE_WORD) open &= ~(uint64_t)0 << (low - w * PHASE_WORD);
    if (high < w * PHASE_WORD + PHASE_WORD - 1)
      open &= ~(~(uint64_t)0 << (high - w * PHASE_WORD + 1));
    for (; open != 0; open &= open - 1) {
      const long x = w * PHASE_WORD + __builtin_ctzll(open);
      const size_t block = row * surfels->blocks[0] + (size_t)x;
      const float inside[4] = {(float)(search->cell[0] - (double)(x * BLOCK) + 1.0),
                               (float)(search->cell[1] - (double)(y * BLOCK) + 1.0),
                               (float)(search->cell[2] - (double)(z * BLOCK) + 1.0), 0.0f};
      if (block != search->near &&
          box_gap(&surfels->boxes[block], inside, search->stretch) <= box_bound(search))
        look_at(search, block, (size_t[3]){(size_t)x, (size_t)y, (size_t)z});
    }
  }
}

/* First and last block along one axis that lie within `reach` cells of the point. */
INLINE void block_range(const struct search *search, int axis, double reach, long range[2]) {
  const long last = (long)search->surfels->blocks[axis] - 1;
  range[0] = (long)floor((search->cell[axis] - reach) * (1.0 / BLOCK));
  range[1] = (long)floor((search->cell[axis] + reach) * (1.0 / BLOCK));
  if (range[0] < 0) range[0] = 0;
  if (range[1] > last) range[1] = last;
}

/* Step k of 0, 1, ... from `home` through first .. last, near ones first; false behind the end. */
INLINE bool step_out(long home, const long range[2], long k, long *at) {
  home = home < range[0] ? range[0] : home > range[1] ? range[1] : home;
  const long down = home - range[0], up = range[1] - home, both = down < up ? down : up;
  if (k > down + up) return false;
  if (k <= 2 * both)
    *at = (k & 1) == 0 ? home + (k >> 1) : home - ((k + 1) >> 1);
  else
    *at = up > down ? home + k - both : home - (k - both);
  return true;
}

INLINE void search_blocks(struct search *search) {
  const struct surfels *surfels = search->surfels;
  const double *stretch = surfels->stretch;
  long ys[2], zs[2], xs[2], home[3], y, z;
  for (int d = 0; d < 3; d++) {
    search->cell[d] = search->point[d] / stretch[d] - 0.5;
    home[d] = (long)floor(search->cell[d] * (1.0 / BLOCK));
  }
  const double unit = 1.0 / stretch[0];
  block_range(search, 2, bound_of(search) / stretch[2], zs);
  block_range(search, 1, bound_of(search) / stretch[1], ys);
  if (zs[0] > zs[1] || ys[0] > ys[1]) return;
  for (long k = 0; step_out(home[2], zs, k, &z); k++) {
    const double z0 = (double)(z * BLOCK);
    const double gz = gap_of(search->cell[2], z0, z0 + BLOCK, stretch[2]);
    if (gz > bound_of(search)) continue;
    for (long j = 0; step_out(home[1], ys, j, &y); j++) {
      const double y0 = (double)(y * BLOCK);
      const double gy = gap_of(search->cell[1], y0, y0 + BLOCK, stretch[1]);
      const double bound = bound_of(search), left = bound * bound - gz * gz - gy * gy;
      if (left < 0.0) continue;
      block_range(search, 0, sqrt(left) * unit, xs);
      if (xs[0] <= xs[1]) look_along(search, y, z, xs[0], xs[1]);
    }
  }
}

TARGETS double surfels_distance(const struct surfels *surfels, const double point[3], double limit,
                                size_t *near) {
  const size_t *n = surfels->blocks;
  const double *stretch = surfels->stretch;
  if (surfels->count == 0) return limit;
  struct search search = {.surfels = surfels,
                          .point = {point[0], point[1], point[2]},
                          .best = limit,
                          .stretch = {(float)stretch[0], (float)stretch[1], (float)stretch[2]},
                          .near = SURFELS_NOWHERE};
  if (*near != SURFELS_NOWHERE)
    look_at(&search, *near, (size_t[3]){*near % n[0], *near / n[0] % n[1], *near / n[0] / n[1]});
  search_blocks(&search);
  double period[2], low[2], high[2]; /* cells lie between 1/2 and size + 1/2 */
  bool inside = true;
  for (int d = 0; d < 2; d++) {
    period[d] = (double)surfels->size[d] * stretch[d];
    low[d] = 0.5 * stretch[d];
    high[d] = low[d] + period[d];
    inside &= point[d] - low[d] > bound_of(&search) && high[d] - point[d] > bound_of(&search);
  }
  for (int i = 0; i < 9 && !inside; i++) {
    const int ix = i % 3 - 1, iy = i / 3 - 1;
    if (i == 4) continue;
    search.point[0] = point[0] + ix * period[0];
    search.point[1] = point[1] + iy * period[1];
    double gap = 0.0;
    for (int d = 0; d < 2; d++) {
      double out = fmax(0.0, fmax(low[d] - search.point[d], search.point[d] - high[d]));
      gap += out * out;
    }
    if (gap < bound_of(&search) * bound_of(&search)) search_blocks(&search);
  }
  *near = search.near;
  return search.best;
}
