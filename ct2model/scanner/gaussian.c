#include "ct2model/scanner/gaussian.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <string.h>

#include "common/variants.h"

size_t gaussian_reflect(long at, size_t n) {
  const long end = (long)n;
  while (at < 0 || at >= end) at = at < 0 ? -1 - at : 2 * end - 1 - at;
  return (size_t)at;
}

static int weights_of(double sigma, float weight[GAUSSIAN_MOST + 1]) {
  int reach = (int)fmin(fmax(ceil(3.5 * sigma), 1.0), GAUSSIAN_MOST);
  double sum = 0.0;
  for (int k = 0; k <= reach; k++)
    sum += (k > 0 ? 2.0 : 1.0) * exp(-0.5 * pow((double)k / sigma, 2.0));
  for (int k = 0; k <= reach; k++)
    weight[k] = (float)(exp(-0.5 * pow((double)k / sigma, 2.0)) / sum);
  return reach;
}

/* out = weight[0] rows[0] + sum over k of weight[k] (rows[-k] + rows[k]), for n voxels per row. The
 * sums of RUN voxels at a time stay in registers, as wide as those of AVX2: wider ones the compiler
 * takes apart in memory there. The last run starts early enough to end with the row, and so
 * overlaps the one before. */
typedef float lanes __attribute__((vector_size(32), aligned(4), may_alias));
enum { WIDE = 8, RUN = 4 * WIDE };
#define AT(row, x) (*(const lanes *)((row) + (x)))
TARGETS static void weigh_rows(const float *const *rows, const float *restrict weight, int reach,
                               size_t n, float *restrict out) {
  for (size_t begin = 0; n >= RUN && begin < n; begin += RUN) {
    const size_t x = begin + RUN <= n ? begin : n - RUN;
    // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): weights are made before
    const float *centre = rows[0] + x, w = weight[0];
    lanes s = w * AT(centre, 0), t = w * AT(centre, WIDE), u = w * AT(centre, 2 * WIDE),
          v = w * AT(centre, 3 * WIDE);
    for (int k = 1; k <= reach; k++) {
      const float *a = rows[-k] + x, *b = rows[k] + x, f = weight[k];
      s += f * (AT(a, 0) + AT(b, 0));
      t += f * (AT(a, WIDE) + AT(b, WIDE));
      u += f * (AT(a, 2 * WIDE) + AT(b, 2 * WIDE));
      v += f * (AT(a, 3 * WIDE) + AT(b, 3 * WIDE));
    }
    lanes *to = (lanes *)(out + x);
    to[0] = s, to[1] = t, to[2] = u, to[3] = v;
  }
  for (size_t begin = 0; n < RUN && n >= WIDE && begin < n; begin += WIDE) { /* short rows */
    const size_t x = begin + WIDE <= n ? begin : n - WIDE;
    lanes s = weight[0] * AT(rows[0] + x, 0);
    for (int k = 1; k <= reach; k++) s += weight[k] * (AT(rows[-k] + x, 0) + AT(rows[k] + x, 0));
    *(lanes *)(out + x) = s;
  }
  for (size_t x = 0; n < WIDE && x < n; x++) {
    // NOLINTNEXTLINE(clang-analyzer-core.UndefinedBinaryOperatorResult): the same
    float sum = weight[0] * rows[0][x];
    for (int k = 1; k <= reach; k++) sum += weight[k] * (rows[-k][x] + rows[k][x]);
    out[x] = sum;
  }
}

/* Filters a row along x in pieces. Each piece is copied together with the voxels on either side,
 * which are reflected at the ends of the row. */
enum { PIECE = 16 * RUN };
static void filter_row(const float *in, const float *weight, int reach, size_t n, float *out) {
  const float *shifted[2 * GAUSSIAN_MOST + 1];
  float line[PIECE + 2 * GAUSSIAN_MOST];
  for (int k = 0; k <= 2 * reach; k++) shifted[k] = line + k;
  for (size_t x = 0; x < n; x += PIECE) {
    const size_t piece = n - x < PIECE ? n - x : PIECE, all = piece + 2 * (size_t)reach;
    for (size_t i = 0; i < all; i++) {
      const long at = (long)(x + i) - reach;
      if (at >= 0 && at < (long)n) {
        const size_t left = n - (size_t)at, count = left < all - i ? left : all - i;
        memcpy(line + i, in + at, count * sizeof *line);
        i += count - 1;
      } else {
        line[i] = in[gaussian_reflect(at, n)];
      }
    }
    weigh_rows(shifted + reach, weight, reach, piece, out + x);
  }
}

struct pass {
  int axis, reach;
  float weight[GAUSSIAN_MOST + 1];
};

/* Filters `along` rows of nx voxels, in_step and out_step apart: along x each by itself, along y or
 * z across them. These are summed in turn: most of the input of the next one is then still in the
 * cache. */
static void filter_rows(const float *in, size_t in_step, size_t along, size_t nx,
                        const struct pass *pass, float *out, size_t out_step) {
  const int reach = pass->reach;
  for (size_t at = 0; at < along; at++) {
    const float *rows[2 * GAUSSIAN_MOST + 1];
    float *to = out + at * out_step;
    if (pass->axis == 0) {
      filter_row(in + at * in_step, pass->weight, reach, nx, to);
      continue;
    }
    const bool inside = at >= (size_t)reach && at + (size_t)reach < along;
    for (int k = -reach; k <= reach; k++) { /* most rows need no reflection */
      const long row = (long)at + k;
      rows[reach + k] = in + (inside ? (size_t)row : gaussian_reflect(row, along)) * in_step;
    }
    weigh_rows(rows + reach, pass->weight, reach, nx, to);
  }
}

/* The filter along an axis; false if there is none. */
static bool pass_start(const size_t size[3], const double sigma[3], int axis, struct pass *pass) {
  if (sigma[axis] < 0.1 || size[axis] < 2) return false;
  pass->axis = axis;
  pass->reach = weights_of(sigma[axis], pass->weight);
  return true;
}

/* Filters along two axes, slice by slice. Each thread has its first slice of `work` for what is
 * between the two. `out` may be `in`. */
static void filter_twice(const float *in, const size_t size[3], const struct pass pass[2],
                         float *work, float *out) {
  const size_t nx = size[0], ny = size[1], plane = nx * ny;
#pragma omp parallel
  {
    float *between = NULL;
#pragma omp for schedule(static)
    for (size_t slice = 0; slice < size[2]; slice++) {
      if (between == NULL) between = work + slice * plane;
      filter_rows(in + slice * plane, nx, ny, nx, &pass[0], between, nx);
      filter_rows(between, nx, ny, nx, &pass[1], out + slice * plane, nx);
    }
  }
}

void gaussian_filter(const float *in, const size_t size[3], const double sigma[3], float *work,
                     float *out) {
  const size_t nx = size[0], ny = size[1], plane = nx * ny;
  const float *from = in;
  struct pass pass[3];
  int n = 0;
  for (int a = 0; a < 3; a++) n += pass_start(size, sigma, a, &pass[n]);
  /* Passes alternate between `work` and `out`, starting so that the last one ends in `out` if the
   * first one may do so; otherwise the result is copied. */
  bool into_work = n % 2 == 0 || in == out;
  for (int i = 0; i < n;) {
    float *to = into_work ? work : out, *then = into_work ? out : work;
    const bool both = i + 1 < n && pass[i + 1].axis == 1;
    if (both) {
      filter_twice(from, size, &pass[i], to, then);
    } else {
      const bool over = pass[i].axis == 2;
      const size_t first = over ? nx : plane, step = over ? plane : nx;
#pragma omp parallel for schedule(static)
      for (size_t slice = 0; slice < (over ? ny : size[2]); slice++)
        filter_rows(from + slice * first, step, over ? size[2] : ny, nx, &pass[i],
                    to + slice * first, step);
    }
    from = both ? then : to;
    into_work = both ? into_work : !into_work;
    i += both ? 2 : 1;
  }
  if (from != out) memcpy(out, from, plane * size[2] * sizeof *in);
}

TARGETS static void sharpen_row(const float *restrict in, const float *restrict y_last,
                                const float *restrict y_next, const float *restrict z_last,
                                const float *restrict z_next, const float w[3], size_t n,
                                float *restrict out) {
  const float centre = 1.0f + 2.0f * (w[0] + w[1] + w[2]);
  for (size_t x = 0; x < n; x++)
    out[x] = centre * in[x] - w[1] * (y_last[x] + y_next[x]) - w[2] * (z_last[x] + z_next[x]);
  for (size_t x = 1; x + 1 < n; x++) out[x] -= w[0] * (in[x - 1] + in[x + 1]);
  out[0] -= w[0] * (in[0] + in[n > 1 ? 1 : 0]);
  if (n > 1) out[n - 1] -= w[0] * (in[n - 1] + in[n - 2]);
}

/* Filters the rows of one y along z into plane[z][x]. */
static void filter_plane(const float *in, const size_t size[3], const struct pass *pass, size_t y,
                         float *plane) {
  const size_t nx = size[0], step = nx * size[1];
  if (pass != NULL) {
    filter_rows(in + y * nx, step, size[2], nx, pass, plane, nx);
    return;
  }
  for (size_t z = 0; z < size[2]; z++)
    memcpy(plane + z * nx, in + y * nx + z * step, nx * sizeof *in);
}

void gaussian_sharpen(float *in, const size_t size[3], const double sigma[3],
                      const double weight[3], float *work, float *out,
                      void (*finish)(const void *context, size_t row, float *out),
                      const void *context) {
  const size_t nx = size[0], ny = size[1], nz = size[2], plane = nx * nz;
  const float w[3] = {(float)weight[0], (float)weight[1], (float)weight[2]};
  const size_t threads = (size_t)omp_get_max_threads(), most = ny / 3 > 0 ? ny / 3 : 1;
  const size_t parts = threads < most ? threads : most;
  struct pass over;
  const bool filtered = pass_start(size, sigma, 2, &over);
  gaussian_filter(in, size, (const double[3]){sigma[0], sigma[1], 0.0}, out, work);
#pragma omp parallel for schedule(static) num_threads(parts)
  for (size_t part = 0; part < parts; part++) {
    const size_t first = ny * part / parts, end = ny * (part + 1) / parts;
    float *planes = in + part * 3 * plane; /* of y - 1, y and y + 1, y modulo 3 */
    for (size_t y = first > 0 ? first - 1 : 0; y < end + (end < ny); y++) {
      filter_plane(work, size, filtered ? &over : NULL, y, planes + y % 3 * plane);
      /* The row before this one has all its neighbours now, and so has the last of all. */
      for (size_t at = y > 0 ? y - 1 : 0; at + 1 <= y + (y + 1 == ny); at++) {
        if (at < first || at >= end) continue;
        const float *here = planes + at % 3 * plane;
        const float *y_last = at > 0 ? planes + (at - 1) % 3 * plane : here;
        const float *y_next = at + 1 < ny ? planes + (at + 1) % 3 * plane : here;
        for (size_t z = 0; z < nz; z++) {
          const size_t row = z * ny + at, back = z > 0 ? (z - 1) * nx : 0;
          const size_t ahead = (z + 1 < nz ? z + 1 : z) * nx;
          sharpen_row(here + z * nx, y_last + z * nx, y_next + z * nx, here + back, here + ahead, w,
                      nx, out + row * nx);
          finish(context, row, out + row * nx);
        }
      }
    }
  }
}

void laplacian_subtract_row(const float *in, const size_t size[3], const double weight[3],
                            size_t row, float *out) {
  const size_t nx = size[0], ny = size[1], nz = size[2];
  const float w[3] = {(float)weight[0], (float)weight[1], (float)weight[2]};
  const size_t y = row % ny, z = row / ny; // NOLINT: a volume has a row
  const size_t y_last = y > 0 ? row - 1 : row, y_next = y + 1 < ny ? row + 1 : row;
  const size_t z_last = z > 0 ? row - ny : row, z_next = z + 1 < nz ? row + ny : row;
  sharpen_row(in + row * nx, in + y_last * nx, in + y_next * nx, in + z_last * nx, in + z_next * nx,
              w, nx, out);
}

void laplacian_subtract(const float *in, const size_t size[3], const double weight[3], float *out) {
  const size_t rows = size[1] * size[2];
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < rows; row++)
    laplacian_subtract_row(in, size, weight, row, out + row * size[0]);
}
