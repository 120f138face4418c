/* Thresholds of a pipeline with their warnings, and what the binary model is worth. */
#ifndef TOSUI_CT2MODEL_BINARISE_H
#define TOSUI_CT2MODEL_BINARISE_H

#include "common/error.h"
#include "ct2model/state.h"

/* Sets the thresholds of both resolutions by the request's rule; warns where the histogram does
 * not bear the match; refuses a reading of the phases that cannot be meant. */
enum status binarise_calibrate(struct pipeline *pipeline);
/* Labels the pores and grains of the model, fills islands if asked, sets void_ratio and quality. */
enum status binarise_connect(struct pipeline *pipeline);

#endif
