#include "ct2model/resample/reduce.h"

#include <math.h>
#include <string.h>

#include "common/variants.h"
#include "common/memory.h"

enum { LANES = RESAMPLE_LANES };

/* Rows are summed while they are in the first-level cache: each input row is added to the few
 * output rows in which it has a weight; an output row is reduced along x once it is complete. */

TARGETS static void start_row(float *restrict sum, const float *restrict row, float weight,
                              size_t n) {
  for (size_t i = 0; i < n; i++) sum[i] = weight * row[i];
}

TARGETS static void add_row(float *restrict sum, const float *restrict row, float weight,
                            size_t n) {
  for (size_t i = 0; i < n; i++) sum[i] += weight * row[i];
}

/* Reduces a row along x. Weights after `count` are zero, and so is `in` after its end. */
TARGETS static void weigh_columns(const float *restrict in, const struct resample_axis *x,
                                  float *restrict out) {
  for (size_t i = 0; i < x->out; i++) {
    const float *weight = x->weight + i * x->taps, *at = in + x->first[i];
    float lane[LANES] = {0};
    for (size_t k = 0; k < x->count[i]; k += LANES)
      for (size_t l = 0; l < LANES; l++) lane[l] += weight[k + l] * at[k + l];
    for (size_t half = LANES / 2; half > 0; half /= 2)
      for (size_t l = 0; l < half; l++) lane[l] += lane[l + half];
    out[i] = lane[0];
  }
}

static size_t pitch_of(const struct resample_axis *x) {
  return (x->in + x->taps + LANES - 1) / LANES * LANES;
}

/* Largest number of output rows in which one input row has a weight. */
static size_t rows_open(const struct resample_axis *y) {
  size_t most = 1;
  for (size_t i = 0, end = 0; i < y->out; i++) {
    while (end < y->out && y->first[end] < y->first[i] + y->count[i]) end++;
    if (end - i > most) most = end - i;
  }
  return most;
}

size_t reduction_scratch(const struct resample_axis *x, const struct resample_axis *y) {
  return rows_open(y) * pitch_of(x);
}

void reduction_start(const struct resample_axis *x, const struct resample_axis *y, float *scratch,
                     float *out, struct reduction *reduction) {
  *reduction = (struct reduction){.x = x, .y = y, .n = x->in, .sums = scratch, .out = out};
  reduction->open = rows_open(y);
  reduction->pitch = pitch_of(x);
  for (size_t i = 0; i < reduction->open; i++)
    memset(scratch + i * reduction->pitch + x->in, 0, (reduction->pitch - x->in) * sizeof *scratch);
}

void reduction_add(struct reduction *reduction, const float *row) {
  const struct resample_axis *x = reduction->x, *y = reduction->y;
  const size_t at = reduction->at++, n = reduction->n, open = reduction->open;
  if (x == NULL) {
    memcpy(reduction->out + at * n, row, n * sizeof *row);
    return;
  }
  for (size_t i = reduction->done; i < y->out && y->first[i] <= at; i++) {
    const float weight = y->weight[i * y->taps + at - y->first[i]];
    float *sum = reduction->sums + i % open * reduction->pitch; // NOLINT: one row at least is open
    if (at == y->first[i])
      start_row(sum, row, weight, n);
    else
      add_row(sum, row, weight, n);
  }
  for (size_t i = reduction->done; i < y->out && y->first[i] + y->count[i] == at + 1; i++) {
    // NOLINTNEXTLINE: one row at least is open
    weigh_columns(reduction->sums + i % open * reduction->pitch, x, reduction->out + i * x->out);
    reduction->done++;
  }
}

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
