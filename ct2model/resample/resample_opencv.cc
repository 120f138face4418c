#include "ct2model/resample/resample_opencv.h"

#include <opencv2/imgproc.hpp>

#include "ct2model/scan/opencv_threads.h"

namespace {

/* OpenCV takes pointers to non-const even where it only reads. */
cv::Mat wrap(const float *data, size_t rows, size_t columns) {
  return cv::Mat(static_cast<int>(rows), static_cast<int>(columns), CV_32F,
                 const_cast<float *>(data));
}

} // namespace

enum status resample_opencv_cubic(const float *in, const size_t in_size[2],
                                  const size_t out_size[2], float *out) {
  try {
    opencv_on_the_caller_only();
    cv::Mat target = wrap(out, out_size[1], out_size[0]);
    cv::resize(wrap(in, in_size[1], in_size[0]), target, target.size(), 0.0, 0.0, cv::INTER_CUBIC);
    return STATUS_OK;
  } catch (const std::exception &error) {
    return FAIL(STATUS_RUN, "resampling: %s", error.what());
  }
}
