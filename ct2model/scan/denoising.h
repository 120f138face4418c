/* What denoising does to the numbers that matter, on the slices of a survey. */
#ifndef TOSUI_CT2MODEL_SCAN_DENOISING_H
#define TOSUI_CT2MODEL_SCAN_DENOISING_H

#include "common/error.h"
#include "ct2model/scan/denoise.h"
#include "ct2model/scan/survey.h"

struct denoise_effect {
  double void_ratio; /* of the denoised slices at the threshold of the noisy ones */
  double surface;    /* grain surface denoised / noisy, each at the threshold of `porosity` */
};

/* `size` of the slices; at most `slices` of the survey's, and their middle of `most` pixels a side.
 */
enum status denoise_effect_measure(const struct survey *survey, const size_t size[2],
                                   enum denoise kind, double porosity, size_t slices, size_t most,
                                   struct denoise_effect *effect);

#endif
