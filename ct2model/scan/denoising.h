/* Effect of denoising on void ratio and surface, measured on the slices of a survey. */
#ifndef TOSUI_CT2MODEL_SCAN_DENOISING_H
#define TOSUI_CT2MODEL_SCAN_DENOISING_H

#include "common/error.h"
#include "ct2model/scan/denoise.h"
#include "ct2model/scan/survey.h"

struct denoise_effect {
  double void_ratio; /* void ratio of the denoised slices at the threshold of the noisy ones */
  double surface;    /* ratio of the grain surface denoised / noisy, each at the threshold of
                        `porosity` */
};

/* `size`: pixels of a slice. At most `slices` slices of the survey are used, and of each the
 * middle, of at most `most` pixels a side. */
enum status denoise_effect_measure(const struct survey *survey, const size_t size[2],
                                   enum denoise kind, double porosity, size_t slices, size_t most,
                                   struct denoise_effect *effect);

#endif
