#include "ct2model/scan/denoising.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/scan/crossing.h"

enum { BINS = 65536 };

static double clamped(const float *slice, const size_t size[2], long x, long y) {
  const long nx = (long)size[0], ny = (long)size[1];
  x = x < 0 ? 0 : x < nx ? x : nx - 1;
  y = y < 0 ? 0 : y < ny ? y : ny - 1;
  return slice[y * nx + x];
}

/* Weight (crossing.h) of the change of phase from a pixel to the next one along an axis; the normal
 * is the sum of Sobel's differences at both. */
static uint64_t crossing_of(const float *slice, const size_t size[2], long x, long y, int axis) {
  double gradient[3] = {0};
  for (int side = 0; side < 2; side++)
    for (int d = -1; d <= 1; d++) {
      const long u = x + (axis == 0 ? side : 0), v = y + (axis == 1 ? side : 0);
      const int w = 2 - abs(d);
      gradient[0] += w * (clamped(slice, size, u + 1, v + d) - clamped(slice, size, u - 1, v + d));
      gradient[1] += w * (clamped(slice, size, u + d, v + 1) - clamped(slice, size, u + d, v - 1));
    }
  return crossing_weight(gradient, axis);
}

/* Length of the walls in slices, in CROSSING_UNIT of a pixel, measured in the planes of the slices
 * in the same way as the specific surface. */
static double wall_length(const float *slices, size_t count, const size_t size[2],
                          double threshold) {
  const size_t nx = size[0], ny = size[1];
  uint64_t length = 0;
  for (size_t row = 0; row < count * ny; row++) {
    // NOLINTNEXTLINE: there is a row
    const float *at = slices + row * nx, *slice = slices + row / ny * nx * ny;
    const size_t y = row % ny;
    for (size_t x = 0; x < nx; x++) {
      const bool grain = (double)at[x] > threshold;
      if (x + 1 < nx && ((double)at[x + 1] > threshold) != grain)
        length += crossing_of(slice, size, (long)x, (long)y, 0);
      if (y + 1 < ny && ((double)at[x + nx] > threshold) != grain)
        length += crossing_of(slice, size, (long)x, (long)y, 1);
    }
  }
  return (double)length;
}

/* Threshold that gives `porosity`, and the share of pixels under the grey `other`. */
static enum status threshold_of(const float *slices, size_t n, double porosity, double other,
                                double *threshold, double *share) {
  enum status status = STATUS_OK;
  struct grey_histogram histogram = {0};
  double low = (double)slices[0], high = low;
  for (size_t i = 0; i < n; i++) {
    low = (double)slices[i] < low ? (double)slices[i] : low;
    high = (double)slices[i] > high ? (double)slices[i] : high;
  }
  TRY(grey_histogram_start(low, high > low ? (high - low) * 1.000001 / BINS : 1.0, BINS,
                           &histogram));
  grey_histogram_add(&histogram, slices, n);
  *threshold = grey_histogram_quantile(&histogram, porosity);
  *share = grey_histogram_porosity(&histogram, other);
cleanup:
  grey_histogram_end(&histogram);
  return status;
}

enum status denoise_effect_measure(const struct survey *survey, const size_t size[2],
                                   enum denoise kind, double porosity, size_t slices, size_t most,
                                   struct denoise_effect *effect) {
  enum status status = STATUS_OK;
  size_t count = survey->count < slices ? survey->count : slices, part[2], first[2];
  float *noisy = NULL, *clean = NULL;
  double raw, after, share;
  for (int d = 0; d < 2; d++) {
    part[d] = size[d] < most ? size[d] : most;
    first[d] = (size[d] - part[d]) / 2;
  }
  size_t plane = part[0] * part[1];
  TRY(memory_allocate(&noisy, count * plane, sizeof *noisy, "slices"));
  TRY(memory_allocate(&clean, count * plane, sizeof *clean, "slices"));
  for (size_t i = 0; i < count; i++) {
    const float *from = survey->sample + (i * survey->count / count * size[1] + first[1]) * size[0];
    for (size_t y = 0; y < part[1]; y++)
      memcpy(noisy + i * plane + y * part[0], from + y * size[0] + first[0],
             part[0] * sizeof *noisy);
  }
  memcpy(clean, noisy, count * plane * sizeof *clean);
#pragma omp parallel for schedule(dynamic)
  for (size_t i = 0; i < count; i++) {
    enum status slice_status = denoise_slice(kind, &survey->phases, part, clean + i * plane);
    if (slice_status != STATUS_OK) {
#pragma omp critical
      status = slice_status;
    }
  }
  if (status != STATUS_OK) goto cleanup;
  TRY(threshold_of(noisy, count * plane, porosity, 0.0, &raw, &share));
  TRY(threshold_of(clean, count * plane, porosity, raw, &after, &share));
  effect->void_ratio = share / (1.0 - share);
  effect->surface = wall_length(clean, count, part, after) / wall_length(noisy, count, part, raw);
cleanup:
  MEMORY_FREE(&noisy, &clean);
  return status;
}
