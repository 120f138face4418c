#include "ct2model/scan/enclosed.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"

/* A cell between eight voxel centres is divided into SUB^3 parts, in each of which the grey is
 * taken to be linear: an eighth of a voxel changes what they enclose by less than 0.1 % of the
 * cells. */
enum { SUB = 2, PARTS = SUB * SUB * SUB, BINS = 4096 };
/* Weight of a part of a cell, an integer, so that sums do not depend on the order. */
static const int64_t WEIGHT = 1 << 20;

/* Counts of one thread. `step`: difference between the count of a bin and that of the previous one;
 * `point`: counts to be added to a bin alone. */
struct counts {
  int64_t step[BINS + 1], point[BINS];
  float *extremes; /* minimum, then maximum, over the corners of each column of a row of cells */
};

static size_t bin_of(double at) {
  const double above = at > 0.0 ? at : 0.0;
  return (size_t)(above < BINS - 1 ? above : BINS - 1);
}

/* Adds greys between `low` and `high`, in bins, with uniform density. Those beyond the bins go to
 * the end bins. */
static void add_greys(struct counts *counts, double low, double high, int64_t weight) {
  const double width = high - low;
  int64_t left = weight;
  if (low < 0.0 && width > 0.0) {
    const int64_t below = (int64_t)((double)weight * fmin(-low / width, 1.0));
    counts->point[0] += below;
    left -= below;
  }
  if (high > BINS && width > 0.0) {
    const int64_t above = (int64_t)((double)weight * fmin((high - BINS) / width, 1.0));
    counts->point[BINS - 1] += above;
    left -= above;
  }
  const size_t first = bin_of(low), last = bin_of(high);
  const int64_t bins = (int64_t)(last - first) + 1, each = left / bins;
  counts->step[first] += each;
  counts->step[last + 1] -= each;
  counts->point[(first + last) / 2] += left - each * bins;
}

/* Adds a cell with corner greys c[x + 2 y + 4 z], in bins. The greys of each part are spread like
 * those of a linear field in a cube, with a width given by the length of its gradient. This is
 * exact across a plane of voxels and has the right variance for any other direction. */
TARGETS static void add_cell(struct counts *counts, const double c[8], int64_t weight) {
  double low[PARTS], high[PARTS];
#pragma omp simd
  for (int part = 0; part < PARTS; part++) {
    const double u = (part % SUB + 0.5) / SUB, v = (part / SUB % SUB + 0.5) / SUB,
                 w = (part / SUB / SUB + 0.5) / SUB; // NOLINT: whole parts are meant
    double x[4], dx[4], y[2], dy[2], dyx[2];
    for (int i = 0; i < 4; i++) {
      dx[i] = c[2 * i + 1] - c[2 * i];
      x[i] = c[2 * i] + u * dx[i];
    }
    for (int i = 0; i < 2; i++) {
      dy[i] = x[2 * i + 1] - x[2 * i];
      dyx[i] = dx[2 * i] + v * (dx[2 * i + 1] - dx[2 * i]);
      y[i] = x[2 * i] + v * dy[i];
    }
    const double grey = y[0] + w * (y[1] - y[0]);
    const double gx = dyx[0] + w * (dyx[1] - dyx[0]), gy = dy[0] + w * (dy[1] - dy[0]),
                 gz = y[1] - y[0];
    const double half = 0.5 / SUB * sqrt(gx * gx + gy * gy + gz * gz);
    low[part] = grey - half, high[part] = grey + half;
  }
  for (int part = 0; part < PARTS; part++) add_greys(counts, low[part], high[part], weight);
}

/* Cell i of an axis lies between centres i - 1 and i. If the axis is mirrored, the first cell is
 * the half voxel between the first centre and its image, and the others occur twice. The half voxel
 * after the last centre is an additional cell if that centre is no mirror plane (`faces`). */
static size_t cell_count(size_t n, const struct enclosed_sides *sides, int axis) {
  return n + (sides->reflect[axis] && sides->faces);
}
static size_t index_before(size_t cell, size_t n, bool reflect) {
  return cell > 0 ? cell - 1 : reflect ? 0 : n - 1;
}
static size_t index_after(size_t cell, size_t n) {
  return cell < n ? cell : n - 1;
}
static int64_t cell_weight(int64_t weight, size_t cell, size_t n, bool reflect) {
  return reflect && cell > 0 && cell < n ? 2 * weight : weight;
}

/* Minimum and maximum of four rows, voxel by voxel. */
TARGETS static void find_extremes(const float *const rows[4], size_t n, float *restrict least,
                                  float *restrict most) {
  const float *a = rows[0], *b = rows[1], *c = rows[2], *d = rows[3];
  for (size_t x = 0; x < n; x++) {
    const float ab = a[x] < b[x] ? a[x] : b[x], cd = c[x] < d[x] ? c[x] : d[x];
    const float ba = a[x] < b[x] ? b[x] : a[x], dc = c[x] < d[x] ? d[x] : c[x];
    least[x] = ab < cd ? ab : cd;
    most[x] = ba < dc ? dc : ba;
  }
}

/* Adds the cells between two rows of one slice and two of the next. Most lie in one phase, outside
 * the bins, or have the same grey at all corners. */
static void add_row(struct counts *counts, const float *const rows[4], size_t nx,
                    const struct enclosed_sides *sides, int64_t weight, double low, double scale) {
  float *const least = counts->extremes, *const most = least + nx;
  find_extremes(rows, nx, least, most);
  for (size_t x = 0; x < cell_count(nx, sides, 0); x++) {
    const size_t there = index_before(x, nx, sides->reflect[0]), here = index_after(x, nx);
    const int64_t full_weight = cell_weight(weight, x, nx, sides->reflect[0]);
    const float less = least[there] < least[here] ? least[there] : least[here];
    const float more = most[there] < most[here] ? most[here] : most[there];
    const double from = ((double)less - low) * scale, to = ((double)more - low) * scale;
    if (from == to || to <= 0.0 || from >= BINS) {
      counts->point[bin_of(from)] += full_weight * PARTS;
      continue;
    }
    double corner[8];
    for (int i = 0; i < 4; i++) {
      corner[2 * i] = ((double)rows[i][there] - low) * scale;
      corner[2 * i + 1] = ((double)rows[i][here] - low) * scale;
    }
    add_cell(counts, corner, full_weight);
  }
}

static void add_slices(struct counts *counts, const float *last, const float *slice,
                       const size_t size[3], const struct enclosed_sides *sides, int64_t weight,
                       double low, double scale) {
  const size_t nx = size[0], ny = size[1];
#pragma omp parallel for schedule(static)
  for (size_t y = 0; y < cell_count(ny, sides, 1); y++) {
    const size_t here = index_after(y, ny) * nx,
                 there = index_before(y, ny, sides->reflect[1]) * nx;
    const float *const rows[4] = {last + there, last + here, slice + there, slice + here};
    add_row(&counts[omp_get_thread_num()], rows, nx, sides,
            cell_weight(weight, y, ny, sides->reflect[1]), low, scale);
  }
}

enum status enclosed_measure(const struct region *region, const struct enclosed_sides *sides,
                             double low, double high, struct grey_histogram *histogram) {
  enum status status = STATUS_OK;
  const size_t plane = region->size[0] * region->size[1], nz = region->size[2];
  const size_t batch = region_batch(region), threads = (size_t)omp_get_max_threads();
  const size_t end = nz - 1;
  const double scale = BINS / (high - low);
  float *slices = NULL; /* last slice of the previous batch, then the batch */
  size_t numbers[64];
  struct counts *counts = NULL;
  int64_t level = 0;
  TRY(grey_histogram_start(low, (high - low) / BINS, BINS, histogram));
  TRY(memory_allocate(&counts, threads, sizeof *counts, "volumes by grey"));
  for (size_t t = 0; t < threads; t++)
    TRY(memory_allocate(&counts[t].extremes, 2 * region->size[0], sizeof(float), "a row of cells"));
  TRY(memory_allocate(&slices, (batch + 1) * plane, sizeof *slices, "slices"));
  numbers[0] = sides->reflect[2] ? 0 : end;
  TRY(region_read(region, numbers, 1, slices));
  for (size_t z = 0; z < nz; z += batch) {
    const size_t n = nz - z < batch ? nz - z : batch;
    for (size_t i = 0; i < n; i++) numbers[i] = z + i;
    TRY(region_read(region, numbers, n, slices + plane));
    for (size_t i = 0; i < n; i++)
      add_slices(counts, slices + i * plane, slices + (i + 1) * plane, region->size, sides,
                 cell_weight(WEIGHT, z + i, nz, sides->reflect[2]), low, scale);
    memcpy(slices, slices + n * plane, plane * sizeof *slices);
  }
  if (cell_count(nz, sides, 2) > nz)
    add_slices(counts, slices, slices, region->size, sides, WEIGHT, low, scale);
  for (size_t b = 0; b < BINS; b++) {
    int64_t point = 0;
    for (size_t t = 0; t < threads; t++) {
      level += counts[t].step[b];
      point += counts[t].point[b];
    }
    histogram->counts[b] = (uint64_t)(level + point);
    histogram->total += histogram->counts[b];
  }
cleanup:
  for (size_t t = 0; t < threads && counts != NULL; t++) memory_free(&counts[t].extremes);
  MEMORY_FREE(&counts, &slices);
  if (status != STATUS_OK) grey_histogram_end(histogram);
  return status;
}

enum status enclosed_match(const struct region *region, const struct enclosed_sides *sides,
                           double low, double high, double *threshold, double *porosity) {
  enum status status = STATUS_OK;
  struct grey_histogram volume = {0};
  TRY(enclosed_measure(region, sides, low, high, &volume));
  const double matched = grey_histogram_quantile(&volume, *porosity);
  if (matched > low + volume.width && matched < high - volume.width) *threshold = matched;
  *porosity = grey_histogram_porosity(&volume, *threshold);
cleanup:
  grey_histogram_end(&volume);
  return status;
}
