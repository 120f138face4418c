#include "ct2model/resample/weights.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

double keys_kernel(double x) {
  const double a = -0.75;
  x = fabs(x);
  if (x < 1.0) return ((a + 2.0) * x - (a + 3.0)) * x * x + 1.0;
  if (x < 2.0) return a * (((x - 5.0) * x + 8.0) * x - 4.0);
  return 0.0;
}

/* Unnormalised weight of input voxel k, whose centre is at k + 1/2, for the output centred at
 * `centre`. */
static double tap(enum filter filter, double centre, double factor, double k) {
  if (filter == FILTER_AREA) {
    double low = fmax(k, centre - 0.5 * factor), high = fmin(k + 1.0, centre + 0.5 * factor);
    return fmax(0.0, high - low);
  }
  return keys_kernel((k + 0.5 - centre) / fmax(factor, 1.0));
}

enum status resample_axis_start(enum filter filter, size_t in, size_t out,
                                struct resample_axis *axis) {
  enum status status = STATUS_OK;
  double factor = (double)in / (double)out;
  double reach = filter == FILTER_AREA ? 0.5 * factor : 2.0 * fmax(factor, 1.0);
  memset(axis, 0, sizeof *axis);
  axis->in = in;
  axis->out = out;
  axis->taps =
      ((size_t)ceil(2.0 * reach) + 2 + RESAMPLE_LANES - 1) / RESAMPLE_LANES * RESAMPLE_LANES;
  TRY(memory_allocate(&axis->first, out, sizeof *axis->first, "resampling weights"));
  TRY(memory_allocate(&axis->count, out, sizeof *axis->count, "resampling weights"));
  TRY(memory_allocate(&axis->weight, out * axis->taps, sizeof *axis->weight, "resampling weights"));
  for (size_t i = 0; i < out; i++) {
    double centre = ((double)i + 0.5) * factor, sum = 0.0;
    double low = fmax(0.0, floor(centre - reach)), high = fmin((double)in, ceil(centre + reach));
    float *weight = axis->weight + i * axis->taps;
    axis->first[i] = (size_t)low;
    axis->count[i] = (size_t)(high - low);
    for (size_t k = 0; k < axis->count[i]; k++) sum += tap(filter, centre, factor, low + (double)k);
    for (size_t k = 0; k < axis->count[i]; k++)
      weight[k] = (float)(tap(filter, centre, factor, low + (double)k) / sum);
  }
cleanup:
  if (status != STATUS_OK) resample_axis_end(axis);
  return status;
}

void resample_axis_end(struct resample_axis *axis) {
  MEMORY_FREE(&axis->first, &axis->count, &axis->weight);
}
