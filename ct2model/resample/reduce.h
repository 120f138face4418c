/* Reduces one slice to the model's columns and rows: the two inner axes of resampling, with one
 * thread per slice. */
#ifndef TOSUI_CT2MODEL_RESAMPLE_REDUCE_H
#define TOSUI_CT2MODEL_RESAMPLE_REDUCE_H

#include <stddef.h>

#include "ct2model/readers/pixels.h"
#include "common/error.h"

/* A slice being reduced. Rows are added from the first to the last, and summed in this order. */
struct reduction {
  const struct resample_axis *x, *y; /* NULL: rows of `n` values are copied */
  size_t n, at, done, open, pitch;
  float *sums, *out;
};

/* Number of floats of work space for a reduction. */
size_t reduction_scratch(const struct resample_axis *x, const struct resample_axis *y);
/* Starts the reduction of a slice to out[y->out][x->out] with the weights of the axes. */
void reduction_start(const struct resample_axis *x, const struct resample_axis *y, float *scratch,
                     float *out, struct reduction *reduction);
/* Adds the next row. */
void reduction_add(struct reduction *reduction, const float *row);

/* Resampling weights of one axis.
 *
 * Bicubic: Keys' kernel (Keys 1981) with a = -0.75, as in OpenCV, stretched by the reduction factor
 * so that it removes what the coarser grid cannot represent, and normalised. Area: the overlap of
 * old and new voxels. Beyond the edge of the image the weights are cut off and normalised again. */

enum filter { FILTER_BICUBIC, FILTER_BICUBIC_POINT, FILTER_AREA, FILTER_NONE };

/* out[i] = sum_k weight[i * taps + k] in[first[i] + k], k < count[i]. `taps` is a multiple of
 * RESAMPLE_LANES, and weights after `count` are zero. first[i] and first[i] + count[i] do not
 * decrease with i. */
enum { RESAMPLE_LANES = 16 };
struct resample_axis {
  size_t in, out, taps;
  size_t *first, *count;
  float *weight;
};

/* Keys' cubic at a distance x, in voxels. */
double keys_kernel(double x);
/* Weights from `in` voxels to `out`. Free with resample_axis_end. */
enum status resample_axis_start(enum filter filter, size_t in, size_t out,
                                struct resample_axis *axis);
void resample_axis_end(struct resample_axis *axis);

#endif
