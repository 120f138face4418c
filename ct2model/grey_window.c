#include "ct2model/grey_window.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/specks.h"

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
                                 .room = room};
  TRY(memory_allocate(&window->field, room * plane, sizeof *window->field, "a window of slices"));
  const size_t threads = (size_t)omp_get_max_threads();
  window->buffer_size = region_buffer_size(region);
  TRY(memory_allocate(&window->buffer, threads, window->buffer_size, "slices"));
  TRY(memory_allocate(&window->row, threads * region->size[0], sizeof *window->row, "rows"));
cleanup:
  if (status != STATUS_OK) grey_window_end(window);
  return status;
}

void grey_window_end(struct grey_window *window) {
  memory_free(&window->field);
  memory_free(&window->buffer);
  memory_free(&window->row);
}

static size_t slice_of(const struct grey_window *window, long z) {
  long n = (long)window->region->size[2];
  if (window->mirror) return (size_t)(z < 0 ? 0 : z >= n ? n - 1 : z);
  return (size_t)(((z % n) + n) % n);
}

/* Greys as distances from the threshold, away from zero, so that the sign is that of the grey
 * against the threshold: the whole part is taken off first, without rounding. */
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
    struct pixel_rows rows;
    enum status one =
        region_read_rows(region, slice_of(window, window->first + (long)(window->depth + i)),
                         window->buffer + thread * window->buffer_size, &rows);
    for (size_t y = 0; y < ny && one == STATUS_OK; y++) {
      pixel_rows_read(&rows, y, nx, row);
      row_distances(row, nx, whole, part, scale, target + y * nx);
    }
    if (one != STATUS_OK) {
#pragma omp critical
      status = one;
    }
  }
  window->depth += n;
  return status;
}

enum status grey_window_move(struct grey_window *window, long first, long end) {
  size_t plane = window->region->size[0] * window->region->size[1];
  if (first < window->low) first = window->low;
  if (end > window->high) end = window->high;
  if (first > window->first) {
    size_t dropped = (size_t)(first - window->first);
    if (dropped > window->depth) dropped = window->depth;
    window->depth -= dropped;
    memmove(window->field, window->field + dropped * plane,
            window->depth * plane * sizeof *window->field);
    window->first = first;
  }
  long missing = end - window->first - (long)window->depth;
  if (missing <= 0) return STATUS_OK;
  /* Islands that reach into the new slices. */
  const size_t from = window->depth > SPECK_REACH ? window->depth - SPECK_REACH : 0;
  enum status status = read_slices(window, (size_t)missing);
  if (status != STATUS_OK || window->speck_limit < 2) return status;
  const size_t size[3] = {window->region->size[0], window->region->size[1], window->depth - from};
  return specks_remove(window->field + from * plane, size, window->speck_limit, &window->specks);
}

/* The six neighbours' rows of row y, layer `deep` of the window; periodic in x and y. */
struct neighbours {
  const int16_t *at, *rows[4]; /* y + 1, y - 1, z + 1, z - 1 */
  size_t nx;
};

static struct neighbours neighbours_of(const struct grey_window *window, size_t y, size_t deep) {
  size_t nx = window->region->size[0], ny = window->region->size[1], plane = nx * ny;
  const int16_t *layer = window->field + deep * plane, *at = layer + y * nx;
  return (struct neighbours){
      .at = at,
      .rows = {layer + (y + 1 < ny ? y + 1 : 0) * nx, layer + (y > 0 ? y - 1 : ny - 1) * nx,
               deep + 1 < window->depth ? at + plane : at, deep > 0 ? at - plane : at},
      .nx = nx};
}

/* Grain shares of one row: 0 or 1 where no neighbour is of the other phase, else that of a voxel
 * cut by the plane that its grey gradient says. The row stands at row[1 .. nx], with what follows
 * it periodically at both ends. */
TARGETS static void row_fractions(const int16_t *restrict row, const int16_t *restrict y_next,
                                  const int16_t *restrict y_last, const int16_t *restrict z_next,
                                  const int16_t *restrict z_last, size_t nx,
                                  float *restrict shares) {
  for (size_t x = 0; x < nx; x++) {
    const int at = row[x + 1], a = row[x + 2], b = row[x], c = y_next[x], d = y_last[x],
              e = z_next[x], f = z_last[x], grain = at > 0;
    const int cut = ((a > 0) ^ grain) | ((b > 0) ^ grain) | ((c > 0) ^ grain) | ((d > 0) ^ grain) |
                    ((e > 0) ^ grain) | ((f > 0) ^ grain);
    const int slope = abs(a - b) + abs(c - d) + abs(e - f);
    float share = 0.5f + 2.0f * (float)at / (float)(slope > 0 ? slope : 1);
    share = share < 0.0f ? 0.0f : share > 1.0f ? 1.0f : share;
    shares[x] = cut & (slope > 0) ? share : (float)grain;
  }
}

void grey_window_changes(const struct grey_window *window, size_t z0, size_t z1,
                         size_t changes[3]) {
  const size_t nx = window->region->size[0], ny = window->region->size[1];
  size_t cx = 0, cy = 0, cz = 0;
#pragma omp parallel for schedule(static) reduction(+ : cx, cy, cz)
  for (size_t row = z0 * ny; row < z1 * ny; row++) {
    const size_t y = row % ny, deep = (size_t)((long)(row / ny) - window->first);
    const struct neighbours near = neighbours_of(window, y, deep);
    size_t along_x = 0, along_y = 0, along_z = 0;
    for (size_t x = 0; x + 1 < nx; x++) along_x += (near.at[x] > 0) != (near.at[x + 1] > 0);
    for (size_t x = 0; x < nx; x++) along_y += (near.at[x] > 0) != (near.rows[0][x] > 0);
    for (size_t x = 0; x < nx; x++) along_z += (near.at[x] > 0) != (near.rows[2][x] > 0);
    cx += along_x;
    if (y + 1 < ny) cy += along_y;
    // NOLINTNEXTLINE: a row lies in a slice of ny > 0
    if (row / ny + 1 < window->region->size[2]) cz += along_z;
  }
  changes[0] += cx;
  changes[1] += cy;
  changes[2] += cz;
}

enum status grey_window_fractions(const struct grey_window *window, size_t z0, size_t z1,
                                  struct resampler *area, float *volume) {
  enum status status = STATUS_OK;
  float *shares = NULL;
  int16_t *padded = NULL;
  const size_t nx = window->region->size[0], ny = window->region->size[1];
  const size_t threads = (size_t)omp_get_max_threads();
  TRY(memory_allocate(&shares, threads * nx * ny, sizeof *shares, "grain fractions"));
  TRY(memory_allocate(&padded, threads * (nx + 2), sizeof *padded, "grain fractions"));
  for (size_t z = z0; z < z1; z += area->batch) {
    size_t n = z1 - z < area->batch ? z1 - z : area->batch;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++) {
      const size_t thread = (size_t)omp_get_thread_num();
      float *slice = shares + thread * nx * ny;
      const struct pixel_rows rows = {slice, nx * sizeof *slice, PIXEL_F32, 1.0f};
      for (size_t y = 0; y < ny; y++) {
        const struct neighbours near =
            neighbours_of(window, y, (size_t)((long)(z + i) - window->first));
        int16_t *row = padded + thread * (nx + 2);
        memcpy(row + 1, near.at, nx * sizeof *row);
        row[0] = near.at[nx - 1];
        row[nx + 1] = near.at[0];
        row_fractions(row, near.rows[0], near.rows[1], near.rows[2], near.rows[3], nx,
                      slice + y * nx);
      }
      (void)resampler_reduce(area, &rows, i); /* area: cannot fail */
    }
    resampler_add(area, z, n, volume);
  }
cleanup:
  memory_free(&shares);
  memory_free(&padded);
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
    size_t x = (size_t)(at[0] + (long)size[0]) % size[0];
    size_t y = (size_t)(at[1] + (long)size[1]) % size[1];
    long deep = at[2] - window->first;
    size_t z = deep < 0 ? 0 : deep >= (long)window->depth ? window->depth - 1 : (size_t)deep;
    value += weight * window->field[(z * size[1] + y) * size[0] + x];
  }
  return value > 0.0;
}
