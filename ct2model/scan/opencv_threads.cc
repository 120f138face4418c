#include "ct2model/scan/opencv_threads.h"

#include <opencv2/core/utility.hpp>

/* cv::setNumThreads destroys the pool that other threads may be in: only the first caller calls it,
 * and the others wait for it (the initialiser of a static variable). */
void opencv_on_the_caller_only() {
  static const int threads = (cv::setNumThreads(1), cv::getNumThreads());
  static_cast<void>(threads);
}
