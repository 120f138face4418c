/* One slice to the model's columns and rows: the two inner axes of resampling, one thread a slice.
 */
#ifndef TOSUI_CT2MODEL_REDUCE_H
#define TOSUI_CT2MODEL_REDUCE_H

#include "ct2model/pixels.h"
#include "ct2model/resample.h"

/* Floats of scratch that reduce_slice needs. */
size_t reduce_scratch(const struct resample_axis *x, const struct resample_axis *y);
/* out[y->out][x->out], each weighted as the axes say. Summed in one fixed order. */
void reduce_slice(const struct pixel_rows *rows, const struct resample_axis *x,
                  const struct resample_axis *y, float *scratch, float *out);

#endif
