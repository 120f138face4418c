/* One slice to the model's columns and rows: the two inner axes of resampling, one thread a slice.
 */
#ifndef TOSUI_CT2MODEL_RESAMPLE_REDUCE_H
#define TOSUI_CT2MODEL_RESAMPLE_REDUCE_H

#include "ct2model/readers/pixels.h"
#include "ct2model/resample/weights.h"

/* A slice on its way: rows are added from the first to the last, and summed in that order. */
struct reduction {
  const struct resample_axis *x, *y; /* NULL: `n` values a row stay as they are */
  size_t n, at, done, open, pitch;
  float *sums, *out;
};

/* Floats of scratch that a reduction needs. */
size_t reduction_scratch(const struct resample_axis *x, const struct resample_axis *y);
/* To out[y->out][x->out], each weighted as the axes say. */
void reduction_start(const struct resample_axis *x, const struct resample_axis *y, float *scratch,
                     float *out, struct reduction *reduction);
void reduction_add(struct reduction *reduction, const float *row);

#endif
