#include "ct2model/resample/resample.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/resample/resample_opencv.h"

/* The slice used for layer k when nothing is averaged: the one at the centre of the layer. */
static size_t point_slice(const struct resampler *resampler, size_t layer) {
  double centre = ((double)layer + 0.5) * (double)resampler->in[2] / (double)resampler->out[2];
  size_t z = (size_t)centre;
  return z < resampler->in[2] ? z : resampler->in[2] - 1;
}

enum status resampler_start(enum filter filter, const size_t in[3], const size_t out[3],
                            size_t batch, struct resampler *resampler) {
  enum status status = STATUS_OK;
  memset(resampler, 0, sizeof *resampler);
  resampler->filter = filter;
  resampler->batch = batch;
  memcpy(resampler->in, in, sizeof resampler->in);
  memcpy(resampler->out, out, sizeof resampler->out);
  if (memcmp(in, out, sizeof resampler->in) == 0) resampler->filter = FILTER_NONE;
  resampler->threads = (size_t)omp_get_max_threads();
  if (resampler->filter == FILTER_BICUBIC || resampler->filter == FILTER_AREA) {
    for (int axis = 0; axis < 3; axis++)
      TRY(resample_axis_start(filter, in[axis], out[axis], &resampler->axes[axis]));
    resampler->scratch_size = reduction_scratch(&resampler->axes[0], &resampler->axes[1]);
  } else if (resampler->filter == FILTER_BICUBIC_POINT) {
    resampler->scratch_size = in[0] * in[1];
  }
  TRY(memory_allocate(&resampler->scratch, resampler->threads * resampler->scratch_size,
                      sizeof *resampler->scratch, "rows being reduced"));
  TRY(memory_allocate(&resampler->planes, batch * out[0] * out[1], sizeof *resampler->planes,
                      "reduced slices"));
cleanup:
  if (status != STATUS_OK) resampler_end(resampler);
  return status;
}

void resampler_end(struct resampler *resampler) {
  for (int axis = 0; axis < 3; axis++) resample_axis_end(&resampler->axes[axis]);
  MEMORY_FREE(&resampler->planes, &resampler->scratch);
}

bool resampler_wants(const struct resampler *resampler, size_t z) {
  if (resampler->filter != FILTER_BICUBIC_POINT) return true;
  for (size_t layer = 0; layer < resampler->out[2]; layer++) {
    if (point_slice(resampler, layer) == z) return true;
  }
  return false;
}

static double layer_weight(const struct resampler *resampler, size_t layer, size_t z) {
  if (resampler->filter == FILTER_BICUBIC_POINT)
    return point_slice(resampler, layer) == z ? 1.0 : 0.0;
  const struct resample_axis *axis = &resampler->axes[2];
  if (z < axis->first[layer] || z >= axis->first[layer] + axis->count[layer]) return 0.0;
  return (double)axis->weight[layer * axis->taps + z - axis->first[layer]];
}

static float *plane_of(const struct resampler *resampler, size_t i) {
  return resampler->planes + i * resampler->out[0] * resampler->out[1];
}

static float *scratch_of(const struct resampler *resampler) {
  return resampler->scratch + (size_t)omp_get_thread_num() * resampler->scratch_size;
}

bool resampler_takes_rows(const struct resampler *resampler) {
  return resampler->filter != FILTER_BICUBIC_POINT;
}

void resampler_begin(struct resampler *resampler, size_t i, struct reduction *reduction) {
  float *plane = plane_of(resampler, i);
  if (resampler->filter == FILTER_NONE)
    *reduction = (struct reduction){.n = resampler->in[0], .out = plane};
  else
    reduction_start(&resampler->axes[0], &resampler->axes[1], scratch_of(resampler), plane,
                    reduction);
}

enum status resampler_point(struct resampler *resampler, const struct pixel_rows *slice, size_t i) {
  const size_t *in = resampler->in;
  float *whole = scratch_of(resampler);
  for (size_t y = 0; y < in[1]; y++) pixel_rows_read(slice, y, in[0], whole + y * in[0]);
  return resample_opencv_cubic(whole, in, resampler->out, plane_of(resampler, i));
}

void resampler_add(const struct resampler *resampler, size_t z0, size_t n, float *volume) {
  const size_t out = resampler->out[0] * resampler->out[1], part = 4096;
  if (resampler->filter == FILTER_NONE) {
    memcpy(volume + z0 * out, resampler->planes, n * out * sizeof *volume);
    return;
  }
#pragma omp parallel for schedule(static)
  for (size_t first = 0; first < out; first += part) {
    size_t end = first + part < out ? first + part : out;
    for (size_t layer = 0; layer < resampler->out[2]; layer++) {
      for (size_t i = 0; i < n; i++) {
        float weight = (float)layer_weight(resampler, layer, z0 + i);
        const float *plane = resampler->planes + i * out;
        float *target = volume + layer * out;
        if (weight == 0.0f) continue;
        for (size_t p = first; p < end; p++) target[p] += weight * plane[p];
      }
    }
  }
}
