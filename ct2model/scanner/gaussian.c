#include "ct2model/scanner/gaussian.h"

#include <math.h>
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
 * sums of RUN voxels at a time stay in registers; the last run starts early enough to end with the
 * row, and so overlaps the one before. */
typedef float lanes __attribute__((vector_size(64), aligned(4), may_alias));
enum { WIDE = 16, RUN = 4 * WIDE };
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
  for (size_t begin = 0; n >= WIDE && n < RUN && begin < n; begin += WIDE) { /* short rows */
    const size_t x = begin + WIDE <= n ? begin : n - WIDE;
    lanes s = weight[0] * AT(rows[0], x);
    for (int k = 1; k <= reach; k++) s += weight[k] * (AT(rows[-k], x) + AT(rows[k], x));
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
enum { PIECE = 8 * RUN };
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

/* Filters one slice of the volume or, along z, the rows of one y. Rows that follow each other along
 * the axis are summed in turn: most of the input of the next one is then still in the cache. */
static void filter_slice(const float *in, const size_t size[3], const struct pass *pass,
                         size_t slice, float *out) {
  const int axis = pass->axis, reach = pass->reach;
  const size_t nx = size[0], ny = size[1], along = axis == 2 ? size[2] : ny;
  const size_t first = axis == 2 ? slice : slice * ny, step = axis == 2 ? ny : 1;
  for (size_t at = 0; at < along; at++) {
    const float *rows[2 * GAUSSIAN_MOST + 1];
    float *to = out + (first + at * step) * nx;
    if (axis == 0) {
      filter_row(in + (first + at * step) * nx, pass->weight, reach, nx, to);
      continue;
    }
    const bool inside = at >= (size_t)reach && at + (size_t)reach < along;
    if (inside) /* most rows: pointers without reflection */
      for (int k = -reach; k <= reach; k++)
        rows[reach + k] = in + (first + at * step) * nx + k * (long)(step * nx);
    else
      for (int k = -reach; k <= reach; k++)
        rows[reach + k] = in + (first + gaussian_reflect((long)at + k, along) * step) * nx;
    weigh_rows(rows + reach, pass->weight, reach, nx, to);
  }
}

void gaussian_filter(const float *in, const size_t size[3], const double sigma[3], float *work,
                     float *out) {
  const size_t bytes = size[0] * size[1] * size[2] * sizeof *in;
  const float *from = in;
  struct pass pass[3];
  int n = 0;
  for (int a = 0; a < 3; a++) {
    if (sigma[a] < 0.1 || size[a] < 2) continue;
    pass[n].axis = a;
    pass[n].reach = weights_of(sigma[a], pass[n].weight);
    n++;
  }
  /* Passes alternate between `work` and `out`, starting so that the last one ends in `out` if the
   * first one may do so; otherwise the result is copied. */
  bool into_work = n % 2 == 0 || in == out;
  for (int i = 0; i < n;) {
    float *to = into_work ? work : out, *then = into_work ? out : work;
    /* The passes along x and y are done slice by slice, while the slice is in the cache. */
    const bool both = i + 1 < n && pass[i + 1].axis == 1;
    const size_t slices = pass[i].axis == 2 ? size[1] : size[2];
#pragma omp parallel for schedule(static)
    for (size_t slice = 0; slice < slices; slice++) {
      filter_slice(from, size, &pass[i], slice, to);
      if (both) filter_slice(to, size, &pass[i + 1], slice, then);
    }
    from = both ? then : to;
    into_work = both ? into_work : !into_work;
    i += both ? 2 : 1;
  }
  if (from != out) memcpy(out, from, bytes);
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
