/* Interface to OpenCV: C++ exceptions are caught and become status values. */
#ifndef TOSUI_CT2MODEL_RESAMPLE_RESAMPLE_OPENCV_H
#define TOSUI_CT2MODEL_RESAMPLE_RESAMPLE_OPENCV_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "common/error.h"

/* cv::resize with INTER_CUBIC, which does not antialias. in_size and out_size: x, y. */
enum status resample_opencv_cubic(const float *in, const size_t in_size[2],
                                  const size_t out_size[2], float *out);

#ifdef __cplusplus
}
#endif

#endif
