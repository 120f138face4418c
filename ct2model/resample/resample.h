/* Resamples a stream of slices to the layers of a model. */
#ifndef TOSUI_CT2MODEL_RESAMPLE_RESAMPLE_H
#define TOSUI_CT2MODEL_RESAMPLE_RESAMPLE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "ct2model/resample/reduce.h"

struct resampler {
  enum filter filter;
  size_t in[3], out[3];
  struct resample_axis axes[3];
  size_t batch;
  float *planes; /* reduced slices of a batch, [batch][out y][out x] */
  float *scratch;
  size_t scratch_size, threads; /* scratch_size: floats of work space per thread */
};

/* Starts resampling from in[3] to out[3] voxels (x, y, z), with `batch` slices at a time. Free with
 * resampler_end. */
enum status resampler_start(enum filter filter, const size_t in[3], const size_t out[3],
                            size_t batch, struct resampler *resampler);
void resampler_end(struct resampler *resampler);
/* Whether slice z has any weight. */
bool resampler_wants(const struct resampler *resampler, size_t z);
/* Slices are put in places i < batch, with one thread per place: row by row into the reduction
 * started by resampler_begin or, if the filter does not take rows, by resampler_point. */
bool resampler_takes_rows(const struct resampler *resampler);
void resampler_begin(struct resampler *resampler, size_t i, struct reduction *reduction);
enum status resampler_point(struct resampler *resampler, const struct pixel_rows *slice, size_t i);
/* Adds the reduced slices z0 .. z0 + n - 1 to volume[out z][out y][out x], which starts as zeros,
 * in an order that does not depend on the number of threads. */
void resampler_add(const struct resampler *resampler, size_t z0, size_t n, float *volume);

#endif
