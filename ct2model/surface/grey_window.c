#include "ct2model/surface/grey_window.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/resample/reduce.h"
#include "ct2model/scan/crossing.h"
#include "ct2model/surface/specks.h"

enum { UNITS_OF_CONTRAST = 8192, SPECK_REACH = 12 };

enum status grey_window_start(const struct region *region, double threshold, double contrast,
                              bool mirror, size_t speck_limit, long low, long high, size_t room,
                              struct grey_window *window) {
  enum status status = STATUS_OK;
  size_t plane = region->size[0] * region->size[1];
  *window = (struct grey_window){.region = region,
                                 .threshold = threshold,
                                 .scale = UNITS_OF_CONTRAST / contrast,
                                 .mirror = mirror,
                                 .speck_limit = speck_limit,
                                 .low = low,
                                 .high = high,
                                 .first = low,
                                 .room = room,
                                 .words = phase_words(region->size[0])};
  const size_t words = room * region->size[1] * window->words;
  const size_t threads = (size_t)omp_get_max_threads();
  TRY(memory_allocate(&window->field, room * plane, sizeof *window->field, "a window of slices"));
  TRY(memory_allocate(&window->bits, words, sizeof *window->bits, "phases"));
  TRY(memory_allocate(&window->scratch, 2 * (words + threads * window->words),
                      sizeof *window->scratch, "phases"));
  window->buffer_size = region_buffer_size(region);
  TRY(memory_allocate(&window->buffer, threads, window->buffer_size, "slices"));
  TRY(memory_allocate(&window->row, threads * region->size[0], sizeof *window->row, "rows"));
cleanup:
  if (status != STATUS_OK) grey_window_end(window);
  return status;
}

void grey_window_end(struct grey_window *window) {
  MEMORY_FREE(&window->field, &window->bits, &window->scratch, &window->buffer, &window->row);
}

static size_t slice_of(const struct grey_window *window, long z) {
  long n = (long)window->region->size[2];
  if (window->mirror) return (size_t)(z < 0 ? 0 : z >= n ? n - 1 : z);
  return (size_t)(((z % n) + n) % n);
}

/* Scales greys to distances from the threshold, rounded away from zero so that the sign is that of
 * the grey relative to the threshold. The integer part of the threshold is subtracted first,
 * without rounding error. */
TARGETS static void row_distances(float *restrict grey, size_t n, float whole, float part,
                                  float scale, int16_t *restrict out) {
  for (size_t i = 0; i < n; i++) {
    const float value = (grey[i] - whole - part) * scale;
    grey[i] = value > 32767.0f ? 32767.0f : value < -32767.0f ? -32767.0f : value;
  }
  for (size_t i = 0; i < n; i++) {
    const int32_t cut = (int32_t)grey[i];
    out[i] = (int16_t)(cut + (grey[i] > (float)cut) - (grey[i] < (float)cut));
  }
}

static enum status read_slices(struct grey_window *window, size_t n) {
  enum status status = STATUS_OK;
  const struct region *region = window->region;
  const size_t nx = region->size[0], ny = region->size[1];
  const float whole = (float)floor(window->threshold);
  const float part = (float)(window->threshold - (double)whole), scale = (float)window->scale;
#pragma omp parallel for schedule(dynamic)
  for (size_t i = 0; i < n; i++) {
    const size_t thread = (size_t)omp_get_thread_num();
    float *row = window->row + thread * nx;
    int16_t *target = window->field + (window->depth + i) * nx * ny;
    uint64_t *bits = window->bits + (window->depth + i) * ny * window->words;
    struct pixel_rows rows;
    enum status slice_status =
        region_read_rows(region, slice_of(window, window->first + (long)(window->depth + i)),
                         window->buffer + thread * window->buffer_size, &rows);
    for (size_t y = 0; y < ny && slice_status == STATUS_OK; y++) {
      pixel_rows_read(&rows, y, nx, row);
      row_distances(row, nx, whole, part, scale, target + y * nx);
      phase_row(target + y * nx, nx, bits + y * window->words);
    }
    if (slice_status != STATUS_OK) {
#pragma omp critical
      status = slice_status;
    }
  }
  window->depth += n;
  return status;
}

enum status grey_window_move(struct grey_window *window, long first, long end) {
  const size_t plane = window->region->size[0] * window->region->size[1];
  const size_t words = window->region->size[1] * window->words;
  if (first < window->low) first = window->low;
  if (end > window->high) end = window->high;
  if (first > window->first) {
    size_t dropped = (size_t)(first - window->first);
    if (dropped > window->depth) dropped = window->depth;
    window->depth -= dropped;
    memmove(window->field, window->field + dropped * plane,
            window->depth * plane * sizeof *window->field);
    memmove(window->bits, window->bits + dropped * words,
            window->depth * words * sizeof *window->bits);
    window->first = first;
  }
  long missing = end - window->first - (long)window->depth;
  if (missing <= 0) return STATUS_OK;
  /* Old slices next to the new ones, for islands that continue into these. */
  const size_t from = window->depth > SPECK_REACH ? window->depth - SPECK_REACH : 0;
  enum status status = read_slices(window, (size_t)missing);
  if (status != STATUS_OK || window->speck_limit < 2) return status;
  const size_t size[3] = {window->region->size[0], window->region->size[1], window->depth - from};
  window->specks += specks_remove(window->field + from * plane, window->bits + from * words, size,
                                  window->speck_limit, window->scratch);
  return STATUS_OK;
}

/* Indices of rows y, y + 1, y - 1 of layer `deep` of the window and of row y of the next and the
 * previous layer: periodic in y, repeated at the ends of the window. */
enum { HERE, Y_NEXT, Y_LAST, Z_NEXT, Z_LAST, NEAR };
static void near_rows(const struct grey_window *window, size_t y, size_t deep, size_t rows[NEAR]) {
  const size_t ny = window->region->size[1], layer = deep * ny;
  rows[HERE] = layer + y;
  rows[Y_NEXT] = layer + (y + 1 < ny ? y + 1 : 0);
  rows[Y_LAST] = layer + (y > 0 ? y - 1 : ny - 1);
  rows[Z_NEXT] = deep + 1 < window->depth ? rows[HERE] + ny : rows[HERE];
  rows[Z_LAST] = deep > 0 ? rows[HERE] - ny : rows[HERE];
}

/* Index in the field of a voxel, or of the nearest one that is held and lies in the region, along
 * an axis. */
static size_t place_along(const struct grey_window *window, int axis, long at) {
  const size_t *n = window->region->size;
  const long held = window->first + (long)window->depth - 1, last = (long)n[axis] - 1;
  const long low = axis == 2 && window->first > 0 ? window->first : 0;
  const long high = axis == 2 && held < last ? held : last;
  at = at < low ? low : at > high ? high : at;
  return axis == 0   ? (size_t)at
         : axis == 1 ? (size_t)at * n[0]
                     : (size_t)(at - window->first) * n[0] * n[1];
}

static int grey_at(const struct grey_window *window, long x, long y, long z) {
  return window
      ->field[place_along(window, 0, x) + place_along(window, 1, y) + place_along(window, 2, z)];
}

/* Weight of the change of phase from a voxel to the next one along an axis. The normal is the sum,
 * over both voxels, of central differences averaged across with weights 1, 2, 1 (Sobel): normals
 * tilted by noise would reduce the area by some per cent. */
static uint64_t weight_of(const struct grey_window *window, const long at[3], int axis) {
  /* Averages and differences of one voxel, and the sums of those of two. */
  static const int means[2][4] = {{1, 2, 1, 0}, {1, 3, 3, 1}},
                   steps[2][4] = {{-1, 0, 1, 0}, {-1, -1, 1, 1}};
  const int *mean[3], *step[3];
  size_t place[3][4];
  int64_t sum[3] = {0};
  for (int a = 0; a < 3; a++) {
    mean[a] = means[a == axis];
    step[a] = steps[a == axis];
    for (int i = 0; i < 4; i++) place[a][i] = place_along(window, a, at[a] + i - 1);
  }
  for (int k = 0; k < 3 + (axis == 2); k++)
    for (int j = 0; j < 3 + (axis == 1); j++) {
      const int16_t *row = window->field + place[2][k] + place[1][j];
      int average = 0, difference = 0;
      for (int i = 0; i < 4; i++) {
        average += mean[0][i] * row[place[0][i]];
        difference += step[0][i] * row[place[0][i]];
      }
      sum[0] += difference * mean[1][j] * mean[2][k];
      sum[1] += average * step[1][j] * mean[2][k];
      sum[2] += average * mean[1][j] * step[2][k];
    }
  double gradient[3];
  for (int a = 0; a < 3; a++) gradient[a] = (double)sum[a] / window->region->voxel[a];
  return crossing_weight(gradient, axis);
}

/* Whether a surface meets a side of the region at one of its outermost voxels: a neighbour within
 * the side is of the other phase. */
static bool meets_side(const struct grey_window *window, const long at[3], int axis) {
  const bool phase = grey_at(window, at[0], at[1], at[2]) > 0;
  for (int n = 0; n < 6; n++) {
    long to[3] = {at[0], at[1], at[2]};
    if (n / 2 == axis) continue;
    to[n / 2] += n % 2 ? 1 : -1;
    if ((grey_at(window, to[0], to[1], to[2]) > 0) != phase) return true;
  }
  return false;
}

/* Sum, in halves, of the weights of the voxels of word w of a row whose bit of `changes` is set. A
 * row of n voxels has n - 1 pairs of neighbours: where the surface meets a side of the region, the
 * first and the last pair stand also for the half voxels beyond them. */
static uint64_t weights_of(const struct grey_window *window, uint64_t changes, size_t w, size_t y,
                           size_t z, int axis) {
  const long last = (long)window->region->size[axis] - 1;
  uint64_t sum = 0;
  for (; changes != 0; changes &= changes - 1) {
    const long at[3] = {(long)w * PHASE_WORD + __builtin_ctzll(changes), (long)y, (long)z};
    long next[3] = {at[0], at[1], at[2]};
    next[axis]++;
    const uint64_t halves = 2U + (at[axis] == 0 && meets_side(window, at, axis)) +
                            (next[axis] == last && meets_side(window, next, axis));
    sum += halves * weight_of(window, at, axis);
  }
  return sum;
}

void grey_window_crossings(const struct grey_window *window, size_t z0, size_t z1,
                           uint64_t crossings[3]) {
  const size_t nx = window->region->size[0], ny = window->region->size[1], words = window->words;
  uint64_t cx = 0, cy = 0, cz = 0;
#pragma omp parallel for schedule(static) reduction(+ : cx, cy, cz)
  for (size_t row = z0 * ny; row < z1 * ny; row++) {
    size_t rows[NEAR];
    const size_t y = row % ny, z = row / ny; // NOLINT: a row lies in a slice of ny > 0
    near_rows(window, y, (size_t)((long)z - window->first), rows);
    const uint64_t *at = window->bits + rows[HERE] * words;
    const uint64_t *y_next = window->bits + rows[Y_NEXT] * words;
    const uint64_t *z_next = window->bits + rows[Z_NEXT] * words;
    for (size_t w = 0; w < words; w++) {
      const uint64_t next = at[w] >> 1 | (w + 1 < words ? at[w + 1] << 63 : 0);
      const size_t pairs = nx - 1 - w * PHASE_WORD; /* pairs from this word on */
      const uint64_t both = pairs < PHASE_WORD ? ((uint64_t)1 << pairs) - 1 : ~(uint64_t)0;
      cx += weights_of(window, (at[w] ^ next) & both, w, y, z, 0);
      if (y + 1 < ny) cy += weights_of(window, at[w] ^ y_next[w], w, y, z, 1);
      if (z + 1 < window->region->size[2]) cz += weights_of(window, at[w] ^ z_next[w], w, y, z, 2);
    }
  }
  crossings[0] += cx;
  crossings[1] += cy;
  crossings[2] += cz;
}

/* Grain volume fractions of n voxels: 0 or 1 if no neighbour is of the other phase, otherwise that
 * of a voxel cut by the plane that follows from its grey and gradient. at[-1] and at[n] must be
 * valid. */
TARGETS static void cut_shares(const int16_t *restrict at, const int16_t *restrict y_next,
                               const int16_t *restrict y_last, const int16_t *restrict z_next,
                               const int16_t *restrict z_last, size_t n, float *restrict shares) {
  for (size_t x = 0; x < n; x++) {
    const int here = at[x], a = at[x + 1], b = at[(long)x - 1], c = y_next[x], d = y_last[x],
              e = z_next[x], f = z_last[x], grain = here > 0;
    const int cut = ((a > 0) ^ grain) | ((b > 0) ^ grain) | ((c > 0) ^ grain) | ((d > 0) ^ grain) |
                    ((e > 0) ^ grain) | ((f > 0) ^ grain);
    const int slope = abs(a - b) + abs(c - d) + abs(e - f);
    float share = 0.5f + 2.0f * (float)here / (float)(slope > 0 ? slope : 1);
    share = share < 0.0f ? 0.0f : share > 1.0f ? 1.0f : share;
    shares[x] = cut & (slope > 0) ? share : (float)grain;
  }
}

TARGETS static void whole_shares(uint64_t grain, uint32_t n, float *restrict shares) {
  for (uint32_t half = 0; half < n; half += 32) {
    const uint32_t bits = (uint32_t)(grain >> half), end = n - half < 32 ? n - half : 32;
    for (uint32_t i = 0; i < end; i++) shares[half + i] = (float)(bits >> i & 1);
  }
}

/* Grain fractions of one row, of which few groups of voxels are cut. The row is stored at row[1 ..
 * nx], with its periodic continuation at both ends; `near` are the other rows. */
enum { GROUP = 16 };
static void row_fractions(const int16_t *row, const int16_t *const near[NEAR],
                          const uint64_t *grain, const uint64_t *cut, size_t nx, float *shares) {
  for (size_t x = 0; x < nx; x += PHASE_WORD)
    whole_shares(grain[x / PHASE_WORD], (uint32_t)(nx - x < PHASE_WORD ? nx - x : PHASE_WORD),
                 shares + x);
  for (size_t x = 0, end; x < nx; x = end + GROUP) {
    for (end = x; end < nx && (cut[end / PHASE_WORD] >> end % PHASE_WORD & 0xffffu) != 0;)
      end += GROUP;
    if (end == x) continue;
    const size_t n = (end < nx ? end : nx) - x;
    cut_shares(row + 1 + x, near[Y_NEXT] + x, near[Y_LAST] + x, near[Z_NEXT] + x, near[Z_LAST] + x,
               n, shares + x);
  }
}

/* Work space of a thread for a row. */
struct row_scratch {
  float *shares;
  int16_t *padded;
  uint64_t *cut, *beside;
};

static void make_fractions(const struct grey_window *window, size_t y, size_t deep,
                           const struct row_scratch *scratch) {
  const size_t nx = window->region->size[0], words = window->words;
  const int16_t *near[NEAR];
  const uint64_t *bits[NEAR];
  size_t rows[NEAR];
  near_rows(window, y, deep, rows);
  for (int i = 0; i < NEAR; i++) {
    near[i] = window->field + rows[i] * nx;
    bits[i] = window->bits + rows[i] * words;
  }
  /* Bits of the voxels that have a neighbour of the other phase. */
  phase_next(bits[HERE], nx, scratch->cut);
  phase_last(bits[HERE], nx, scratch->beside);
  for (size_t w = 0; w < words; w++) {
    const uint64_t at = bits[HERE][w];
    scratch->cut[w] = (at ^ scratch->cut[w]) | (at ^ scratch->beside[w]) | (at ^ bits[Y_NEXT][w]) |
                      (at ^ bits[Y_LAST][w]) | (at ^ bits[Z_NEXT][w]) | (at ^ bits[Z_LAST][w]);
  }
  memcpy(scratch->padded + 1, near[HERE], nx * sizeof *scratch->padded);
  scratch->padded[0] = near[HERE][nx - 1];
  scratch->padded[nx + 1] = near[HERE][0];
  row_fractions(scratch->padded, near, bits[HERE], scratch->cut, nx, scratch->shares);
}

enum status grey_window_fractions(const struct grey_window *window, size_t z0, size_t z1,
                                  struct resampler *area, float *volume) {
  enum status status = STATUS_OK;
  float *shares = NULL;
  int16_t *padded = NULL;
  const size_t nx = window->region->size[0], ny = window->region->size[1], words = window->words;
  const size_t threads = (size_t)omp_get_max_threads();
  TRY(memory_allocate(&shares, threads * nx, sizeof *shares, "grain fractions"));
  TRY(memory_allocate(&padded, threads * (nx + 2), sizeof *padded, "grain fractions"));
  for (size_t z = z0; z < z1; z += area->batch) {
    size_t n = z1 - z < area->batch ? z1 - z : area->batch;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++) {
      const size_t thread = (size_t)omp_get_thread_num();
      const struct row_scratch scratch = {shares + thread * nx, padded + thread * (nx + 2),
                                          window->scratch + 2 * thread * words,
                                          window->scratch + (2 * thread + 1) * words};
      struct reduction reduction;
      resampler_begin(area, i, &reduction);
      for (size_t y = 0; y < ny; y++) {
        make_fractions(window, y, (size_t)((long)(z + i) - window->first), &scratch);
        reduction_add(&reduction, scratch.shares);
      }
    }
    resampler_add(area, z, n, volume);
  }
cleanup:
  MEMORY_FREE(&shares, &padded);
  return status;
}

bool grey_window_in_grain(const struct grey_window *window, const double point[3]) {
  const size_t *size = window->region->size;
  long low[3];
  double part[3], value = 0.0;
  for (int d = 0; d < 3; d++) {
    double at = point[d] - 0.5;
    low[d] = (long)floor(at);
    part[d] = at - (double)low[d];
  }
  for (unsigned c = 0; c < 8; c++) {
    long at[3];
    double weight = 1.0;
    for (unsigned d = 0; d < 3; d++) {
      at[d] = low[d] + (long)(c >> d & 1);
      weight *= (c >> d & 1) != 0 ? part[d] : 1.0 - part[d];
    }
    if (weight == 0.0) continue; /* most centres are those of voxels of the scan */
    size_t x = (size_t)(at[0] + (long)size[0]) % size[0];
    size_t y = (size_t)(at[1] + (long)size[1]) % size[1];
    long deep = at[2] - window->first;
    size_t z = deep < 0 ? 0 : deep >= (long)window->depth ? window->depth - 1 : (size_t)deep;
    value += weight * window->field[(z * size[1] + y) * size[0] + x];
  }
  return value > 0.0;
}
