#include "ct2model/grey_window.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/connect.h"

enum { UNITS_OF_CONTRAST = 8192 };

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
  TRY(memory_allocate(&window->greys, region_batch(region) * plane, sizeof *window->greys,
                      "slices"));
cleanup:
  if (status != STATUS_OK) grey_window_end(window);
  return status;
}

void grey_window_end(struct grey_window *window) {
  memory_free(&window->field);
  memory_free(&window->greys);
}

static size_t slice_of(const struct grey_window *window, long z) {
  long n = (long)window->region->size[2];
  if (window->mirror) return (size_t)(z < 0 ? 0 : z >= n ? n - 1 : z);
  return (size_t)(((z % n) + n) % n);
}

static enum status read_slices(struct grey_window *window, size_t n) {
  enum status status = STATUS_OK;
  size_t plane = window->region->size[0] * window->region->size[1];
  size_t batch = region_batch(window->region), numbers[64];
  while (n > 0) {
    size_t some = n < batch ? n : batch;
    int16_t *target = window->field + window->depth * plane;
    for (size_t i = 0; i < some; i++)
      numbers[i] = slice_of(window, window->first + (long)(window->depth + i));
    TRY(region_read(window->region, numbers, some, window->greys));
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < some * plane; i++) {
      double value = ((double)window->greys[i] - window->threshold) * window->scale;
      /* Away from zero, so that the sign is that of the grey against the threshold. */
      value = value > 0.0 ? fmin(ceil(value), 32767.0) : fmax(floor(value), -32767.0);
      target[i] = (int16_t)value;
    }
    window->depth += some;
    n -= some;
  }
cleanup:
  return status;
}

static bool is_speck(const struct part *part, const void *context) {
  return part->voxels < *(const size_t *)context && !part->at_border;
}

/* Islands far smaller than a model voxel are noise to the model and would spoil the distances
 * around them: they take the phase around them. */
static enum status remove_specks(struct grey_window *window) {
  enum status status = STATUS_OK;
  uint8_t *grain = NULL;
  struct parts parts = {0};
  const size_t size[3] = {window->region->size[0], window->region->size[1], window->depth};
  const bool periodic[3] = {true, true, false};
  size_t voxels = size[0] * size[1] * size[2];
  size_t limit = window->speck_limit;
  if (limit < 2) return STATUS_OK;
  TRY(memory_allocate(&grain, voxels, 1, "grain voxels"));
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < voxels; i++) grain[i] = window->field[i] > 0;
  size_t changed = 0;
  for (uint8_t phase = 0; phase < 2; phase++) {
    TRY(parts_find(grain, size, periodic, phase, &parts));
    changed += parts_paint(&parts, is_speck, &limit, phase == 0, grain);
    parts_end(&parts);
  }
  window->specks += changed;
  if (changed == 0) goto cleanup;
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < voxels; i++) {
    if ((window->field[i] > 0) != (grain[i] != 0))
      window->field[i] = (int16_t)(window->field[i] == 0 ? 1 : -window->field[i]);
  }
cleanup:
  parts_end(&parts);
  memory_free(&grain);
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
  enum status status = read_slices(window, (size_t)missing);
  return status == STATUS_OK ? remove_specks(window) : status;
}

/* Grain share of a voxel cut by the plane that its grey gradient says; 0 or 1 where no
 * neighbour is of the other phase. */
static float voxel_fraction(const struct grey_window *window, size_t x, size_t y, size_t z) {
  size_t nx = window->region->size[0], ny = window->region->size[1], plane = nx * ny;
  const int16_t *at = window->field + z * plane;
  const int16_t *up = z + 1 < window->depth ? at + plane : at, *down = z > 0 ? at - plane : at;
  size_t here = y * nx + x;
  int16_t value = at[here];
  int16_t around[6] = {at[y * nx + (x + 1) % nx],
                       at[y * nx + (x + nx - 1) % nx],
                       at[(y + 1) % ny * nx + x],
                       at[(y + ny - 1) % ny * nx + x],
                       up[here],
                       down[here]};
  bool cut = false;
  double slope = 0.0;
  for (int d = 0; d < 3; d++) {
    cut |= (around[2 * d] > 0) != (value > 0) || (around[2 * d + 1] > 0) != (value > 0);
    slope += 0.5 * fabs((double)around[2 * d] - (double)around[2 * d + 1]);
  }
  if (!cut || slope == 0.0) return value > 0 ? 1.0f : 0.0f;
  return (float)fmin(1.0, fmax(0.0, 0.5 + (double)value / slope));
}

enum status grey_window_fractions(const struct grey_window *window, size_t z0, size_t z1,
                                  struct resampler *area, float *volume, size_t changes[3]) {
  enum status status = STATUS_OK;
  float *shares = NULL;
  size_t nx = window->region->size[0], ny = window->region->size[1], plane = nx * ny;
  TRY(memory_allocate(&shares, area->batch * plane, sizeof *shares, "grain fractions"));
  for (size_t z = z0; z < z1; z += area->batch) {
    size_t n = z1 - z < area->batch ? z1 - z : area->batch;
    size_t cx = 0, cy = 0, cz = 0;
#pragma omp parallel for schedule(static) reduction(+ : cx, cy, cz)
    for (size_t row = 0; row < n * ny; row++) {
      size_t y = row % ny, deep = (size_t)((long)(z + row / ny) - window->first);
      const int16_t *at = window->field + deep * plane + y * nx;
      bool last_y = y + 1 == ny, last_z = z + row / ny + 1 == window->region->size[2];
      for (size_t x = 0; x < nx; x++) {
        shares[row * nx + x] = voxel_fraction(window, x, y, deep);
        bool grain = at[x] > 0;
        if (x + 1 < nx) cx += grain != (at[x + 1] > 0);
        if (!last_y) cy += grain != (at[x + nx] > 0);
        if (!last_z) cz += grain != (at[x + plane] > 0);
      }
    }
    changes[0] += cx;
    changes[1] += cy;
    changes[2] += cz;
    TRY(resampler_feed(area, z, n, shares, volume));
  }
cleanup:
  memory_free(&shares);
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
