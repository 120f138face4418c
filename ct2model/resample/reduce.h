/* Reduces one slice to the model's columns and rows: the two inner axes of resampling, with one
 * thread per slice. */
#ifndef TOSUI_CT2MODEL_RESAMPLE_REDUCE_H
#define TOSUI_CT2MODEL_RESAMPLE_REDUCE_H

#include "ct2model/readers/pixels.h"
#include "ct2model/resample/weights.h"

/* A slice being reduced. Rows are added from the first to the last, and summed in this order. */
struct reduction {
  const struct resample_axis *x, *y; /* NULL: rows of `n` values are copied */
  size_t n, at, done, open, pitch;
  float *sums, *out;
};

/* Number of floats of work space for a reduction. */
size_t reduction_scratch(const struct resample_axis *x, const struct resample_axis *y);
/* Starts the reduction of a slice to out[y->out][x->out] with the weights of the axes. */
void reduction_start(const struct resample_axis *x, const struct resample_axis *y, float *scratch,
                     float *out, struct reduction *reduction);
/* Adds the next row. */
void reduction_add(struct reduction *reduction, const float *row);

#endif
