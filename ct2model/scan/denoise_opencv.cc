#include "ct2model/scan/denoise.h"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

#include "ct2model/scan/opencv_threads.h"

namespace {

/* Non-local means (Buades, Coll, Morel 2005) over patches of 5x5 pixels: a patch at distance d, the
 * mean of |a - b|, counts exp(-d^2 / h^2). Two patches that differ by noise of deviation s alone
 * have d of mean 2 s / sqrt(pi) and, over 25 pixels, deviation s sqrt(2 - 4 / pi) / 5. h is chosen
 * so that a patch as far away as one in twenty of those weighs 1/e of the mean one: what is farther
 * is another thing. */
double strength_in_noise() {
  const double patch = 5.0, one_in_twenty = 1.645;
  const double mean = 2.0 / std::sqrt(M_PI), deviation = std::sqrt(2.0 - mean * mean) / patch;
  const double far = mean + one_in_twenty * deviation;
  return std::sqrt(far * far - mean * mean); /* 0.84 */
}

/* OpenCV's takes whole numbers: pore at 8192, grain at 16384. */
void nlm(const grey_phases &phases, cv::Mat &slice) {
  const double strength = strength_in_noise();
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
    opencv_on_the_caller_only();
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
