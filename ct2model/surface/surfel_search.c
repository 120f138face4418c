#include "ct2model/surface/surfels.h"

#include <math.h>
#include <stdbool.h>

#include "common/variants.h"
#include "ct2model/surface/specks.h"

enum { BLOCK = SURFELS_BLOCK, POINTS = SURFELS_POINTS, BITS = BLOCK * BLOCK * BLOCK };
/* All of the search is inlined into one function, which is compiled for each instruction set. */
#define INLINE __attribute__((always_inline)) static inline

/* Search for the discs nearest to a tile of adjacent points, all at a time. */
struct search {
  const struct surfels *surfels;
  double point[3][POINTS];
  double low[3], high[3];    /* bounding box of the points, in cells from the first one */
  float relative[3][POINTS]; /* the points relative to its low corner, in cells */
  float stretch[3];
  float square[POINTS]; /* squared distances so far */
  float bound[POINTS];  /* squared distances from which on boxes are skipped */
  double best;          /* the largest distance so far */
  size_t near;          /* block of the disc nearest to the middle point so far */
  size_t done;          /* a block that has been searched already */
};

/* Normals are rounded to 1/127 in each component, so that the height over a disc may be up to 0.68
 * % too small. No disc in a box beyond the bound is nearer than the best one. */
INLINE void find_bounds(struct search *search) {
  float most = 0.0f;
#pragma omp simd reduction(max : most)
  for (int p = 0; p < POINTS; p++) {
    const float distance = sqrtf(search->square[p]), far = 1.00695f * (distance + 1e-3f);
    search->bound[p] = far * far;
    most = distance > most ? distance : most;
  }
  search->best = (double)most;
}

/* Squared distances of the points, which are relative to the first corner of the first cell, to the
 * nearest of n discs, if less than `square`. */
INLINE void nearest_discs(const uint32_t *restrict places, const uint32_t *restrict normals, int n,
                          float at[3][POINTS], const float stretch[3],
                          float square[restrict POINTS]) {
  const float radius = (float)SURFELS_RADIUS;
  float disc[6][BITS];
  for (int i = 0; i < n; i++) {
    const uint32_t place = places[i], normal = normals[i];
    disc[0][i] = stretch[0] / 255.0f * (float)(int)(place & 1023u);
    disc[1][i] = stretch[1] / 255.0f * (float)(int)(place >> 10 & 1023u);
    disc[2][i] = stretch[2] / 255.0f * (float)(int)(place >> 20 & 1023u);
    disc[3][i] = (float)((int)(normal << 24) >> 24);
    disc[4][i] = (float)((int)(normal << 16) >> 24);
    disc[5][i] = (float)((int)(normal << 8) >> 24);
  }
  for (int i = 0; i < n; i++) {
#pragma omp simd
    for (int p = 0; p < POINTS; p++) {
      const float x = at[0][p] - disc[0][i], y = at[1][p] - disc[1][i], z = at[2][p] - disc[2][i];
      const float height = (x * disc[3][i] + y * disc[4][i] + z * disc[5][i]) * (1.0f / 127.0f);
      const float aside = x * x + y * y + z * z - height * height;
      const float outside = sqrtf(aside > 0.0f ? aside : 0.0f) - radius;
      const float excess = outside > 0.0f ? outside : 0.0f;
      const float candidate = height * height + excess * excess;
      square[p] = candidate < square[p] ? candidate : square[p];
    }
  }
}

INLINE void search_block(struct search *search, size_t block, const size_t at[3]) {
  const struct surfels *surfels = search->surfels;
  const uint32_t first = surfels->first[block], end = surfels->first[block + 1];
  const float middle = search->square[SURFELS_MIDDLE];
  float local[3][POINTS];
  for (int d = 0; d < 3; d++) {
    const double origin = ((double)(at[d] * BLOCK) + 0.5) * surfels->stretch[d];
#pragma omp simd
    for (int p = 0; p < POINTS; p++) local[d][p] = (float)(search->point[d][p] - origin);
  }
  nearest_discs(surfels->items + first, surfels->items + surfels->count + first, (int)(end - first),
                local, search->stretch, search->square);
  if (search->square[SURFELS_MIDDLE] < middle) search->near = block;
  find_bounds(search);
}

/* Whether a disc of the block may be nearer to one of the points. */
INLINE bool is_near(const struct search *search, size_t block, const size_t at[3]) {
  const struct surfel_box *box = &search->surfels->boxes[block];
  float low[3], high[3];
  for (int d = 0; d < 3; d++) {
    const double corner = (double)(at[d] * BLOCK) - 1.0 - search->low[d];
    low[d] = (float)(corner + (double)box->low[d] * (1.0 / SURFELS_PARTS));
    high[d] = (float)(corner + (double)box->high[d] * (1.0 / SURFELS_PARTS));
  }
  int near = 0;
#pragma omp simd reduction(| : near)
  for (int p = 0; p < POINTS; p++) {
    float gap = 0.0f;
    for (int d = 0; d < 3; d++) {
      const float below = low[d] - search->relative[d][p], above = search->relative[d][p] - high[d];
      const float out = below > above ? below : above;
      const float length = (out > 0.0f ? out : 0.0f) * search->stretch[d];
      gap += length * length;
    }
    near |= gap <= search->bound[p];
  }
  return near != 0;
}

/* Distance from a block beyond which its discs cannot be nearer; slightly more than a radius, for
 * rounding. */
INLINE double bound_of(const struct search *search) {
  return search->best + SURFELS_RADIUS + 1e-3;
}

/* Distance along one axis from the bounding box of the points, in cells, to a block. */
INLINE double block_gap(const struct search *search, int axis, long block) {
  const double start = (double)(block * BLOCK);
  const double below = start - search->high[axis], above = search->low[axis] - start - BLOCK;
  const double gap = below > above ? below : above;
  return gap > 0.0 ? gap * search->surfels->stretch[axis] : 0.0;
}

/* Searches the blocks of a row from `low` to `high` in which a disc may be nearer. */
INLINE void search_row(struct search *search, long y, long z, long low, long high) {
  const struct surfels *surfels = search->surfels;
  const size_t row = (size_t)z * surfels->blocks[1] + (size_t)y;
  for (long w = low / PHASE_WORD; w <= high / PHASE_WORD; w++) {
    uint64_t open = surfels->occupied[row * surfels->words + (size_t)w];
    if (low > w * PHASE_WORD) open &= ~(uint64_t)0 << (low - w * PHASE_WORD);
    if (high < w * PHASE_WORD + PHASE_WORD - 1)
      open &= ~(~(uint64_t)0 << (high - w * PHASE_WORD + 1));
    for (; open != 0; open &= open - 1) {
      const size_t x = (size_t)(w * PHASE_WORD + __builtin_ctzll(open));
      const size_t block = row * surfels->blocks[0] + x, at[3] = {x, (size_t)y, (size_t)z};
      if (block != search->done && is_near(search, block, at)) search_block(search, block, at);
    }
  }
}

/* First and last block along an axis that lie within `reach` cells of the points. */
INLINE void block_range(const struct search *search, int axis, double reach, long range[2]) {
  const long last = (long)search->surfels->blocks[axis] - 1;
  range[0] = (long)floor((search->low[axis] - reach) * (1.0 / BLOCK));
  range[1] = (long)floor((search->high[axis] + reach) * (1.0 / BLOCK));
  if (range[0] < 0) range[0] = 0;
  if (range[1] > last) range[1] = last;
}

/* Step k of 0, 1, ... through first .. last, in order of the distance from `home`; false after the
 * last. */
INLINE bool step_outwards(long home, const long range[2], long k, long *at) {
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
  const double *stretch = search->surfels->stretch;
  long ys[2], zs[2], xs[2], home[3], y, z;
  for (int d = 0; d < 3; d++) {
    search->low[d] = INFINITY;
    search->high[d] = -INFINITY;
    for (int p = 0; p < POINTS; p++) {
      const double cell = search->point[d][p] / stretch[d] - 0.5;
      search->low[d] = cell < search->low[d] ? cell : search->low[d];
      search->high[d] = cell > search->high[d] ? cell : search->high[d];
    }
#pragma omp simd
    for (int p = 0; p < POINTS; p++)
      search->relative[d][p] = (float)(search->point[d][p] / stretch[d] - 0.5 - search->low[d]);
    home[d] = (long)floor(0.5 * (search->low[d] + search->high[d]) * (1.0 / BLOCK));
  }
  const double unit = 1.0 / stretch[0];
  block_range(search, 2, bound_of(search) / stretch[2], zs);
  block_range(search, 1, bound_of(search) / stretch[1], ys);
  if (zs[0] > zs[1] || ys[0] > ys[1]) return;
  for (long k = 0; step_outwards(home[2], zs, k, &z); k++) {
    const double gz = block_gap(search, 2, z);
    if (gz > bound_of(search)) continue;
    for (long j = 0; step_outwards(home[1], ys, j, &y); j++) {
      const double gy = block_gap(search, 1, y);
      const double bound = bound_of(search), left = bound * bound - gz * gz - gy * gy;
      if (left < 0.0) continue;
      block_range(search, 0, sqrt(left) * unit, xs);
      if (xs[0] <= xs[1]) search_row(search, y, z, xs[0], xs[1]);
    }
  }
}

/* Searches the images of the points one period further along x and y, if they are near enough. */
INLINE void search_images(struct search *search, const struct surfel_points *points) {
  const struct surfels *surfels = search->surfels;
  double period[2], low[2], high[2], from[2], to[2]; /* cells lie between 1/2 and size + 1/2 */
  bool inside = true;
  for (int d = 0; d < 2; d++) {
    const double stretch = surfels->stretch[d];
    period[d] = (double)surfels->size[d] * stretch;
    low[d] = 0.5 * stretch;
    high[d] = low[d] + period[d];
    from[d] = (search->low[d] + 0.5) * stretch;
    to[d] = (search->high[d] + 0.5) * stretch;
    inside &= from[d] - low[d] > bound_of(search) && high[d] - to[d] > bound_of(search);
  }
  for (int i = 0; i < 9 && !inside; i++) {
    const double shift[2] = {(i % 3 - 1) * period[0], (i / 3 - 1) * period[1]}; // NOLINT: whole
    double gap = 0.0;
    if (i == 4) continue;
    for (int d = 0; d < 2; d++) {
      const double out = fmax(0.0, fmax(low[d] - to[d] - shift[d], from[d] + shift[d] - high[d]));
      gap += out * out;
      for (int p = 0; p < POINTS; p++) search->point[d][p] = points->at[d][p] + shift[d];
    }
    if (gap < bound_of(search) * bound_of(search)) search_blocks(search);
  }
}

TARGETS void surfels_distances(const struct surfels *surfels, struct surfel_points *points,
                               size_t *near) {
  const size_t *n = surfels->blocks;
  double *distance = points->distance;
  struct search search = {.surfels = surfels, .near = SURFELS_NOWHERE, .done = *near};
  if (surfels->count > 0) {
    for (int d = 0; d < 3; d++) {
      search.stretch[d] = (float)surfels->stretch[d];
      for (int p = 0; p < POINTS; p++) search.point[d][p] = points->at[d][p];
    }
    /* At least the exact square, so that the comparison below leaves distances that are not
     * improved unchanged. */
    for (int p = 0; p < POINTS; p++)
      search.square[p] = (float)(distance[p] * distance[p]) * (1.0f + 2e-7f);
    find_bounds(&search);
    if (*near != SURFELS_NOWHERE)
      search_block(&search, *near,
                   (size_t[3]){*near % n[0], *near / n[0] % n[1], *near / n[0] / n[1]});
    search_blocks(&search);
    search.done = SURFELS_NOWHERE;
    search_images(&search, points);
    for (int p = 0; p < POINTS; p++) {
      const double square = (double)search.square[p];
      if (square < distance[p] * distance[p]) distance[p] = sqrt(square);
    }
  }
  *near = search.near;
}

void surfel_points_place(const size_t at[3], const size_t size[2], const double factor[3],
                         const double stretch[3], double limit, struct surfel_points *points) {
  for (size_t p = 0; p < POINTS; p++) {
    size_t place[3] = {at[0] + p % SURFELS_SIDE, at[1] + p / SURFELS_SIDE, at[2]};
    for (int d = 0; d < 2; d++)
      if (place[d] >= size[d]) place[d] = size[d] - 1;
    for (int d = 0; d < 3; d++)
      points->at[d][p] = ((double)place[d] + 0.5) * factor[d] * stretch[d];
    points->distance[p] = limit;
  }
}

void surfel_points_bound(double step, double limit, double last[SURFELS_SIDE],
                         struct surfel_points *points) {
  for (size_t p = 0; p < POINTS; p++) {
    const double most = fmin(limit, 1.0001 * (last[p / SURFELS_SIDE] + step));
    if (points->distance[p] > most) points->distance[p] = most;
    last[p / SURFELS_SIDE] = points->distance[p];
  }
}
