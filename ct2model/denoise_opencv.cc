#include "ct2model/denoise.h"

#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

namespace {

/* OpenCV's non-local means takes whole numbers: pore at 8192, grain at 16384. */
void nlm(const grey_phases &phases, cv::Mat &slice) {
  const double strength = 0.8; /* times the noise; more rounds edges off */
  const double scale = 8192.0 / (phases.grain_peak - phases.pore_peak);
  const double shift = 8192.0 - scale * phases.pore_peak;
  cv::Mat whole, clean;
  slice.convertTo(whole, CV_16U, scale, shift);
  cv::fastNlMeansDenoising(whole, clean, {static_cast<float>(strength * scale * phases.noise)}, 5,
                           15, cv::NORM_L1);
  clean.convertTo(slice, CV_32F, 1.0 / scale, -shift / scale);
}

} // namespace

enum status denoise_slice(enum denoise kind, const grey_phases *phases, const size_t size[2],
                          float *slice) {
  try {
    cv::setNumThreads(1); /* the slices are the parallel loop */
    cv::Mat image(static_cast<int>(size[1]), static_cast<int>(size[0]), CV_32F, slice);
    if (kind == DENOISE_MEDIAN)
      cv::medianBlur(image.clone(), image, 5);
    else if (kind == DENOISE_NLM)
      nlm(*phases, image);
    return STATUS_OK;
  } catch (const std::exception &error) {
    return FAIL(STATUS_RUN, "denoising: %s", error.what());
  }
}
