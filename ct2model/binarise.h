/* Thresholds of a pipeline with their warnings, and the quality of the binary model. */
#ifndef TOSUI_CT2MODEL_BINARISE_H
#define TOSUI_CT2MODEL_BINARISE_H

#include "common/error.h"
#include "ct2model/state.h"

/* Sets the thresholds at both resolutions by the request's rule; warns if the histogram does not
 * support the match, and refuses a polarity of the phases that cannot be intended. */
enum status binarise_calibrate(struct pipeline *pipeline);
/* Labels the pores and grains of the model, fills islands if requested, and sets void_ratio and
 * quality. */
enum status binarise_connect(struct pipeline *pipeline);

#endif
