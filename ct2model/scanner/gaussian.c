#include "ct2model/scanner/gaussian.h"

#include <math.h>
#include <string.h>

#include "common/variants.h"

static size_t reflect(long at, size_t n) {
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

TARGETS static void scale_row(const float *restrict in, float w, size_t n, float *restrict out) {
  for (size_t x = 0; x < n; x++) out[x] = w * in[x];
}

TARGETS static void add_rows(const float *restrict a, const float *restrict b, float w, size_t n,
                             float *restrict out) {
  for (size_t x = 0; x < n; x++) out[x] += w * (a[x] + b[x]);
}

/* Along x, in two parts: voxels whose taps all lie in the row, and those at its ends. */
static void filter_row(const float *in, const float *weight, int reach, size_t n, float *out) {
  const size_t r = (size_t)reach;
  scale_row(in, weight[0], n, out);
  for (int k = 1; k <= reach; k++) {
    if (n > 2 * r) add_rows(in + r - (size_t)k, in + r + (size_t)k, weight[k], n - 2 * r, out + r);
    for (size_t x = 0; x < n; x++) {
      if (n > 2 * r && x == r) x = n - r;
      out[x] += weight[k] * (in[reflect((long)x - k, n)] + in[reflect((long)x + k, n)]);
    }
  }
}

static void filter_axis(const float *in, const size_t size[3], int axis, double sigma, float *out) {
  float weight[GAUSSIAN_MOST + 1];
  const int reach = weights_of(sigma, weight);
  const size_t nx = size[0], ny = size[1], nz = size[2];
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < ny * nz; row++) {
    const size_t y = row % ny, z = row / ny; // NOLINT: a volume has a row
    const float *from = in + row * nx;
    float *to = out + row * nx;
    if (axis == 0) {
      filter_row(from, weight, reach, nx, to);
      continue;
    }
    scale_row(from, weight[0], nx, to);
    for (int k = 1; k <= reach; k++) {
      const size_t a =
          axis == 1 ? z * ny + reflect((long)y - k, ny) : reflect((long)z - k, nz) * ny + y;
      const size_t b =
          axis == 1 ? z * ny + reflect((long)y + k, ny) : reflect((long)z + k, nz) * ny + y;
      add_rows(in + a * nx, in + b * nx, weight[k], nx, to);
    }
  }
}

void gaussian_filter(const float *in, const size_t size[3], const double sigma[3], float *work,
                     float *out) {
  const size_t bytes = size[0] * size[1] * size[2] * sizeof *in;
  int axes[3], n = 0;
  for (int a = 0; a < 3; a++)
    if (sigma[a] >= 0.1 && size[a] > 1) axes[n++] = a;
  if (n == 0 && in != out) memcpy(out, in, bytes);
  if (n == 0) return;
  if (n == 2) { /* in -> work -> out */
    filter_axis(in, size, axes[0], sigma[axes[0]], work);
    filter_axis(work, size, axes[1], sigma[axes[1]], out);
    return;
  }
  /* in -> out -> work (-> out), or in -> work -> out where there is one axis or both are one. */
  filter_axis(in, size, axes[0], sigma[axes[0]], work);
  if (n == 3) {
    filter_axis(work, size, axes[1], sigma[axes[1]], out);
    filter_axis(out, size, axes[2], sigma[axes[2]], work);
  }
  memcpy(out, work, bytes);
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

void laplacian_subtract(const float *in, const size_t size[3], const double weight[3], float *out) {
  const size_t nx = size[0], ny = size[1], nz = size[2];
  const float w[3] = {(float)weight[0], (float)weight[1], (float)weight[2]};
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < ny * nz; row++) {
    const size_t y = row % ny, z = row / ny; // NOLINT: a volume has a row
    const size_t y_last = y > 0 ? row - 1 : row, y_next = y + 1 < ny ? row + 1 : row;
    const size_t z_last = z > 0 ? row - ny : row, z_next = z + 1 < nz ? row + ny : row;
    sharpen_row(in + row * nx, in + y_last * nx, in + y_next * nx, in + z_last * nx,
                in + z_next * nx, w, nx, out + row * nx);
  }
}
