/* The only door to OpenCV: C++ exceptions end here and become status values. */
#ifndef TOSUI_CT2MODEL_RESAMPLE_OPENCV_H
#define TOSUI_CT2MODEL_RESAMPLE_OPENCV_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "common/error.h"
#include "ct2model/resample.h"

/* Before anything else, from one thread: OpenCV uses no threads of its own. */
enum status resample_opencv_start(void);
/* in[y->in][x->in] to out[y->out][x->out] by the axes' weights: the products W_y in W_x^T, each
 * band of taps as one cv::gemm. */
enum status resample_opencv_weighted(const float *in, const struct resample_axis *x,
                                     const struct resample_axis *y, float *out);
/* cv::resize with INTER_CUBIC, which does not antialias. in_size and out_size: x, y. */
enum status resample_opencv_cubic(const float *in, const size_t in_size[2],
                                  const size_t out_size[2], float *out);

#ifdef __cplusplus
}
#endif

#endif
