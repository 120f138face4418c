/* The pass over all pixels: histogram and resampling, slice by slice, with one thread per slice. */
#ifndef TOSUI_CT2MODEL_SCAN_H
#define TOSUI_CT2MODEL_SCAN_H

#include "ct2model/state.h"

/* Fills the pipeline's histogram, middle slice and, if it is resampled, volume. The result does not
 * depend on the number of threads. */
enum status scan_take(struct pipeline *pipeline);

#endif
