/* Void ratio and grey histogram as functions of the threshold, at both resolutions. */
#ifndef TOSUI_CT2MODEL_CALIBRATE_SWEEP_TABLE_H
#define TOSUI_CT2MODEL_CALIBRATE_SWEEP_TABLE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "ct2model/calibrate/calibrate.h"

/* Rows in rising order of the reported grey. Solid is the grain side of the threshold. For an
 * integer scan the thresholds lie half-way between levels, where "above" and "at or above" are the
 * same. The histograms count the voxels between the threshold of the previous row and that of this
 * row. */
struct sweep_table {
  size_t count;
  double *threshold;
  double *void_ratio, *histogram;                     /* original resolution */
  double *void_ratio_resampled, *histogram_resampled; /* NULL without a resampled volume */
};

/* Input of a sweep: greys at full resolution and, unless NULL, the resampled volume, counted as
 * mirrored. A reported grey is `unit` times one of these; with dark grains it decreases as they
 * increase. */
struct sweep_source {
  const struct grey_histogram *histogram;
  const float *volume;
  struct mirroring mirroring;
  double unit;
  bool dark_grains;
};
/* Free with sweep_table_end. */
enum status sweep_table_make(const struct sweep_source *source, struct sweep_table *table);
void sweep_table_end(struct sweep_table *table);
/* CSV: threshold,void_ratio,histogram,void_ratio_resampled,histogram_resampled. */
enum status sweep_table_write(const struct sweep_table *table, const char *path);

#endif
