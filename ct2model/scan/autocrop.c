#include "ct2model/scan/autocrop.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"

enum { BLOCKS = 48, BLOCK_PIXELS_LEAST = 8, SLICES = 24 };
/* BRUSH: blocks on each side of the middle of a brush. WIDE: number of its positions along a side
 * of the slice, including those that reach in from outside. */
enum { BRUSH = 1, WIDE = BLOCKS + 2 * BRUSH };

struct blocks {
  size_t n; /* n x n blocks of one slice */
  double mean[BLOCKS * BLOCKS], deviation[BLOCKS * BLOCKS];
};

static void measure_blocks(const struct region *region, const float *slice, struct blocks *blocks) {
  size_t n = blocks->n;
  double counts[BLOCKS * BLOCKS] = {0};
  memset(blocks->mean, 0, sizeof blocks->mean);
  memset(blocks->deviation, 0, sizeof blocks->deviation);
  for (size_t y = 0; y < region->size[1]; y++) {
    for (size_t x = 0; x < region->size[0]; x++) {
      size_t b = y * n / region->size[1] * n + x * n / region->size[0];
      double grey = (double)slice[y * region->size[0] + x];
      blocks->mean[b] += grey;
      blocks->deviation[b] += grey * grey;
      counts[b] += 1.0;
    }
  }
  for (size_t b = 0; b < n * n; b++) {
    blocks->mean[b] /= counts[b];
    blocks->deviation[b] =
        sqrt(fmax(0.0, blocks->deviation[b] / counts[b] - blocks->mean[b] * blocks->mean[b]));
  }
}

/* Grey of the surroundings, which are smooth and fill the corners; NAN if the corners are not of
 * one grey that differs from the middle of the slice. */
static double surrounding_grey(const struct blocks *blocks, double *middle) {
  size_t n = blocks->n, count = 0;
  const size_t corners[4] = {0, n - 1, n * (n - 1), n * n - 1};
  double mean = 0.0, spread = 0.0;
  *middle = 0.0;
  for (size_t y = n * 3 / 8; y < n - n * 3 / 8; y++)
    for (size_t x = n * 3 / 8; x < n - n * 3 / 8; x++, count++) *middle += blocks->mean[y * n + x];
  *middle /= (double)count;
  for (int c = 0; c < 4; c++) mean += 0.25 * blocks->mean[corners[c]];
  for (int c = 0; c < 4; c++)
    spread = fmax(spread, fabs(blocks->mean[corners[c]] - mean) + blocks->deviation[corners[c]]);
  return spread < 0.4 * fabs(*middle - mean) ? mean : NAN;
}

/* Range of the blocks that the brush covers along one axis. Its middle is counted from BRUSH blocks
 * before the first one. */
static size_t brush_first(size_t middle) {
  return middle > 2 * BRUSH ? middle - 2 * BRUSH : 0;
}
static size_t brush_end(size_t middle, size_t n) {
  return middle < n ? middle + 1 : n;
}

/* Whether all blocks under the brush at (x, y) are like the surroundings; everything beyond the
 * slice is. */
static bool brush_fits(const bool *like, size_t n, size_t x, size_t y) {
  for (size_t v = brush_first(y); v < brush_end(y, n); v++)
    for (size_t u = brush_first(x); u < brush_end(x, n); u++)
      if (!like[v * n + u]) return false;
  return true;
}

/* Clears inside[] for blocks like the corners that the brush reaches from outside the slice. A
 * large pore in the middle belongs to the specimen, and so do pores that open to the surroundings
 * but are narrower than the brush. */
static void clear_outside(const struct blocks *blocks, double outside, double middle,
                          bool *inside) {
  const size_t n = blocks->n, wide = n + 2 * BRUSH;
  bool like[BLOCKS * BLOCKS], fits[WIDE * WIDE], reached[WIDE * WIDE], grows = true;
  for (size_t b = 0; b < n * n; b++)
    like[b] = fabs(blocks->mean[b] - outside) < 0.6 * fabs(middle - outside);
  for (size_t b = 0; b < wide * wide; b++) {
    const size_t x = b % wide, y = b / wide;
    fits[b] = brush_fits(like, n, x, y);
    reached[b] = fits[b] && (x == 0 || y == 0 || x == wide - 1 || y == wide - 1);
  }
  while (grows) {
    grows = false;
    for (size_t b = wide; b < wide * (wide - 1); b++) {
      if (!fits[b] || reached[b])
        continue; /* all positions that fit at the ends of a row are
                     reached already */
      reached[b] = reached[b - 1] || reached[b + 1] || reached[b - wide] || reached[b + wide];
      grows |= reached[b];
    }
  }
  for (size_t b = 0; b < wide * wide; b++) {
    if (!reached[b]) continue;
    const size_t x = b % wide, y = b / wide;
    for (size_t v = brush_first(y); v < brush_end(y, n); v++)
      for (size_t u = brush_first(x); u < brush_end(x, n); u++) inside[v * n + u] = false;
  }
}

/* The largest rectangle of true cells: x0, y0, nx, ny in blocks. */
static void largest_rectangle(const bool *inside, size_t n, size_t best[4]) {
  size_t height[BLOCKS] = {0}, area = 0;
  for (size_t y = 0; y < n; y++) {
    for (size_t x = 0; x < n; x++) height[x] = inside[y * n + x] ? height[x] + 1 : 0;
    for (size_t x = 0; x < n; x++) {
      size_t least = height[x];
      for (size_t end = x; end < n && least > 0; end++) {
        if (height[end] < least) least = height[end];
        size_t here = (end - x + 1) * least;
        if (here <= area) continue;
        area = here;
        best[0] = x;
        best[1] = y + 1 - least;
        best[2] = end - x + 1;
        best[3] = least;
      }
    }
  }
}

/* Reads a slice of the whole stack. Pixels that are NaN or infinite, as tools write around a
 * specimen, are replaced by a grey that no other pixel has, so that they are smooth and unlike the
 * middle. */
static enum status read_slice(const struct region *region, size_t z, float *slice) {
  const size_t count = region->size[0] * region->size[1];
  const float scale = (float)region->scale;
  float low = INFINITY, high = -INFINITY;
  const enum status status = stack_read(region->stack, region->origin[2] + z, slice);
  for (size_t i = 0; i < count && status == STATUS_OK; i++) {
    slice[i] *= scale;
    if (!isfinite(slice[i])) continue;
    low = fminf(low, slice[i]), high = fmaxf(high, slice[i]);
  }
  for (size_t i = 0; i < count && status == STATUS_OK; i++)
    if (!isfinite(slice[i])) slice[i] = low - (high - low);
  return status;
}

enum status autocrop(struct region *region) {
  enum status status = STATUS_OK;
  size_t nz = region->size[2] < SLICES ? region->size[2] : SLICES, found = 0, best[4] = {0};
  size_t least = region->size[0] < region->size[1] ? region->size[0] : region->size[1];
  bool inside[BLOCKS * BLOCKS];
  float *slice = NULL;
  struct blocks *blocks = NULL;
  TRY(memory_allocate(&slice, region->size[0] * region->size[1], sizeof *slice, "a slice"));
  TRY(memory_allocate(&blocks, 1, sizeof *blocks, "blocks of a slice"));
  blocks->n = least / BLOCK_PIXELS_LEAST < BLOCKS ? least / BLOCK_PIXELS_LEAST : BLOCKS;
  memset(inside, true, sizeof inside);
  for (size_t i = 0; i < nz && blocks->n >= BLOCK_PIXELS_LEAST; i++) {
    size_t z = nz > 1 ? i * (region->size[2] - 1) / (nz - 1) : 0;
    double middle;
    TRY(read_slice(region, z, slice));
    measure_blocks(region, slice, blocks);
    double outside = surrounding_grey(blocks, &middle);
    if (isnan(outside)) continue;
    clear_outside(blocks, outside, middle, inside);
    found++;
  }
  if (5 * found < 4 * nz) { /* dark corners here and there are pores */
    log_info("--crop auto: no surroundings found, the whole stack is specimen");
    goto cleanup;
  }
  size_t n = blocks->n;
  largest_rectangle(inside, n, best);
  if (best[2] < 5 || best[3] < 5)
    TRY_FAIL(STATUS_INPUT, "%s: --crop auto finds no box inside the specimen; give --crop",
             region->stack->files[0].path);
  for (size_t d = 0; d < 2; d++) { /* one block less on each side: the outermost ones are mixed */
    best[d]++;
    best[d + 2] -= 2;
    size_t whole = region->size[d];
    region->origin[d] = (best[d] * whole + n - 1) / n;
    region->size[d] = (best[d] + best[d + 2]) * whole / n - region->origin[d];
  }
  log_info("--crop auto: --crop %zu,%zu,0,%zu,%zu,%zu", region->origin[0], region->origin[1],
           region->size[0], region->size[1], region->size[2]);
cleanup:
  MEMORY_FREE(&slice, &blocks);
  return status;
}
