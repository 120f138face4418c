/* Resampling weights of one axis.
 *
 * Bicubic: Keys' kernel (Keys 1981) with a = -0.75, as in OpenCV, stretched by the reduction factor
 * so that it removes what the coarser grid cannot represent, and normalised. Area: the overlap of
 * old and new voxels. Beyond the edge of the image the weights are cut off and normalised again. */
#ifndef TOSUI_CT2MODEL_RESAMPLE_WEIGHTS_H
#define TOSUI_CT2MODEL_RESAMPLE_WEIGHTS_H

#include <stddef.h>

#include "common/error.h"

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
