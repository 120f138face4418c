/* Removes noise from slices on request: median or non-local means, slice by slice (OpenCV; C++
 * exceptions are caught inside). */
#ifndef TOSUI_CT2MODEL_SCAN_DENOISE_H
#define TOSUI_CT2MODEL_SCAN_DENOISE_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#include "common/error.h"
#include "ct2model/calibrate/calibrate.h"

enum denoise { DENOISE_NONE, DENOISE_MEDIAN, DENOISE_NLM };

/* Filters slice[y][x] in place. Median: of 5x5 pixels. Non-local means (Buades et al. 2005):
 * patches of 5x5 in a window of 15x15 pixels, weighted by the noise of `phases`. */
enum status denoise_slice(enum denoise kind, const struct grey_phases *phases, const size_t size[2],
                          float *slice);

#ifdef __cplusplus
}
#endif

#endif
