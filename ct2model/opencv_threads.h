/* The slices are the parallel loop: OpenCV starts no threads of its own. */
#ifndef TOSUI_CT2MODEL_OPENCV_THREADS_H
#define TOSUI_CT2MODEL_OPENCV_THREADS_H

#include <opencv2/core/utility.hpp>

/* Before each call into OpenCV, from any thread; throws what OpenCV throws. cv::setNumThreads takes
 * down the arena that other threads may be in, so only the first caller reaches it and the others
 * wait for it. */
inline void opencv_on_the_caller_only() {
  static const int threads = (cv::setNumThreads(1), cv::getNumThreads());
  static_cast<void>(threads);
}

#endif
