#include "ct2model/grey_window.h"

#include <math.h>
#include <omp.h>
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
      value = value > 32767.0 ? 32767.0 : value < -32767.0 ? -32767.0 : value;
      /* Away from zero, so that the sign is that of the grey against the threshold. */
      int whole = (int)value;
      target[i] = (int16_t)(whole + (value > whole) - (value < whole));
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

/* Grain share of a voxel cut by the plane that its grey gradient says. */
static float voxel_fraction(const struct neighbours *n, size_t x) {
  double value = (double)n->at[x];
  double slope =
      fabs((double)n->at[x + 1 < n->nx ? x + 1 : 0] - (double)n->at[x > 0 ? x - 1 : n->nx - 1]);
  for (int d = 0; d < 4; d += 2) slope += fabs((double)n->rows[d][x] - (double)n->rows[d + 1][x]);
  if (slope == 0.0) return value > 0.0 ? 1.0f : 0.0f;
  double share = 0.5 + 2.0 * value / slope;
  return (float)(share < 0.0 ? 0.0 : share > 1.0 ? 1.0 : share);
}

/* Grain shares of one row: 0 or 1 where no neighbour is of the other phase. `cut` is scratch. */
static void row_fractions(const struct neighbours *n, uint8_t *cut, float *shares) {
  const int16_t *at = n->at;
  const size_t nx = n->nx;
  for (size_t x = 0; x < nx; x++) {
    bool grain = at[x] > 0;
    cut[x] = (uint8_t)(((n->rows[0][x] > 0) != grain) | ((n->rows[1][x] > 0) != grain) |
                       ((n->rows[2][x] > 0) != grain) | ((n->rows[3][x] > 0) != grain));
    shares[x] = grain ? 1.0f : 0.0f;
  }
  for (size_t x = 0; x + 1 < nx; x++) {
    uint8_t changes = (at[x] > 0) != (at[x + 1] > 0);
    cut[x] |= changes;
    cut[x + 1] |= changes;
  }
  if ((at[0] > 0) != (at[nx - 1] > 0)) cut[0] = cut[nx - 1] = 1;
  for (size_t x = 0; x < nx; x++)
    if (cut[x] != 0) shares[x] = voxel_fraction(n, x);
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
  uint8_t *cut = NULL;
  const size_t nx = window->region->size[0], ny = window->region->size[1];
  const size_t threads = (size_t)omp_get_max_threads();
  TRY(memory_allocate(&shares, threads * nx * ny, sizeof *shares, "grain fractions"));
  TRY(memory_allocate(&cut, threads * nx, 1, "grain fractions"));
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
        row_fractions(&near, cut + thread * nx, slice + y * nx);
      }
      (void)resampler_reduce(area, &rows, i); /* area: cannot fail */
    }
    resampler_add(area, z, n, volume);
  }
cleanup:
  memory_free(&shares);
  memory_free(&cut);
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
