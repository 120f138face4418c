#include "ct2model/scan/opencv_threads.h"

#include <opencv2/core/utility.hpp>

/* cv::setNumThreads takes down the arena that other threads may be in: only the first caller reaches
 * it, and the others wait for it (a static's initialiser). */
void opencv_on_the_caller_only() {
  static const int threads = (cv::setNumThreads(1), cv::getNumThreads());
  static_cast<void>(threads);
}
