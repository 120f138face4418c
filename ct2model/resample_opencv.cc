#include "ct2model/resample_opencv.h"

#include <opencv2/imgproc.hpp>

namespace {

/* OpenCV takes pointers to non-const even where it only reads. */
cv::Mat wrap(const float *data, size_t rows, size_t columns) {
  return cv::Mat(static_cast<int>(rows), static_cast<int>(columns), CV_32F,
                 const_cast<float *>(data));
}

void weigh(const float *in, const resample_axis &x, const resample_axis &y, float *out) {
  cv::Mat source = wrap(in, y.in, x.in), target = wrap(out, y.out, x.out);
  cv::Mat rows(static_cast<int>(y.out), static_cast<int>(x.in), CV_32F);
  for (size_t i = 0; i < y.out; i++) {
    int first = static_cast<int>(y.first[i]), count = static_cast<int>(y.count[i]);
    cv::Mat row = rows.row(static_cast<int>(i));
    cv::gemm(wrap(y.weight + i * y.taps, 1, y.count[i]), source.rowRange(first, first + count), 1.0,
             cv::noArray(), 0.0, row);
  }
  cv::Mat column(static_cast<int>(y.out), 1, CV_32F);
  for (size_t i = 0; i < x.out; i++) {
    int first = static_cast<int>(x.first[i]), count = static_cast<int>(x.count[i]);
    cv::gemm(rows.colRange(first, first + count), wrap(x.weight + i * x.taps, x.count[i], 1), 1.0,
             cv::noArray(), 0.0, column);
    column.copyTo(target.col(static_cast<int>(i)));
  }
}

} // namespace

enum status resample_opencv_start(void) {
  try {
    cv::setNumThreads(1); /* the slices are the parallel loop */
    return STATUS_OK;
  } catch (const std::exception &error) {
    return FAIL(STATUS_RUN, "resampling: %s", error.what());
  }
}

enum status resample_opencv_weighted(const float *in, const resample_axis *x,
                                     const resample_axis *y, float *out) {
  try {
    weigh(in, *x, *y, out);
    return STATUS_OK;
  } catch (const std::exception &error) {
    return FAIL(STATUS_RUN, "resampling: %s", error.what());
  }
}

enum status resample_opencv_cubic(const float *in, const size_t in_size[2],
                                  const size_t out_size[2], float *out) {
  try {
    cv::Mat target = wrap(out, out_size[1], out_size[0]);
    cv::resize(wrap(in, in_size[1], in_size[0]), target, target.size(), 0.0, 0.0, cv::INTER_CUBIC);
    return STATUS_OK;
  } catch (const std::exception &error) {
    return FAIL(STATUS_RUN, "resampling: %s", error.what());
  }
}
