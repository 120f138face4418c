/* The slices are the parallel loop: OpenCV starts no threads of its own. C++ only. */
#ifndef TOSUI_CT2MODEL_SCAN_OPENCV_THREADS_H
#define TOSUI_CT2MODEL_SCAN_OPENCV_THREADS_H

/* Before each call into OpenCV, from any thread; throws what OpenCV throws. */
void opencv_on_the_caller_only();

#endif
