#include "ct2model/reduce.h"

#include <string.h>

#include "common/variants.h"

enum { LANES = RESAMPLE_LANES };

/* Rows are summed while they are in the nearest cache: each input row goes into the few output rows
 * that it has a weight in, and an output row is reduced along x once it is complete. */

TARGETS static void start_row(float *restrict sum, const float *restrict row, float weight,
                              size_t n) {
  for (size_t i = 0; i < n; i++) sum[i] = weight * row[i];
}

TARGETS static void add_row(float *restrict sum, const float *restrict row, float weight,
                            size_t n) {
  for (size_t i = 0; i < n; i++) sum[i] += weight * row[i];
}

/* Weights behind `count` are zero, and so is what `in` holds behind its end. */
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

/* The most output rows that one input row has a weight in. */
static size_t rows_open(const struct resample_axis *y) {
  size_t most = 1;
  for (size_t i = 0, end = 0; i < y->out; i++) {
    while (end < y->out && y->first[end] < y->first[i] + y->count[i]) end++;
    if (end - i > most) most = end - i;
  }
  return most;
}

size_t reduce_scratch(const struct resample_axis *x, const struct resample_axis *y) {
  return (1 + rows_open(y)) * pitch_of(x);
}

void reduce_slice(const struct pixel_rows *rows, const struct resample_axis *x,
                  const struct resample_axis *y, float *scratch, float *out) {
  const size_t pitch = pitch_of(x), open = rows_open(y), n = x->in;
  float *row = scratch, *sums = scratch + pitch;
  for (size_t i = 0; i < open; i++) memset(sums + i * pitch + n, 0, (pitch - n) * sizeof *sums);
  for (size_t at = 0, done = 0; at < y->in && done < y->out; at++) {
    pixel_rows_read(rows, at, n, row);
    for (size_t i = done; i < y->out && y->first[i] <= at; i++) {
      const float weight = y->weight[i * y->taps + at - y->first[i]];
      float *sum = sums + i % open * pitch; // NOLINT: one row at least is open
      if (at == y->first[i])
        start_row(sum, row, weight, n);
      else
        add_row(sum, row, weight, n);
    }
    for (; done < y->out && y->first[done] + y->count[done] == at + 1; done++)
      // NOLINTNEXTLINE: one row at least is open
      weigh_columns(sums + done % open * pitch, x, out + done * x->out);
  }
}
