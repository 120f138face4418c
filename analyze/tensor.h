/* The permeability tensor that sphsolve run --tensor stores in the run file (/run/tensor). */
#ifndef TOSUI_ANALYZE_TENSOR_H
#define TOSUI_ANALYZE_TENSOR_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "analyze/run_file.h"

struct tensor {
  double k[9], low[9], high[9]; /* m/s, 95 % interval; row: flow along x, y, z, column: gradient */
  double principal[3], principal_low[3], principal_high[3]; /* m/s, largest first */
  /* Unit vectors of the principal axes, one per row. */
  double axes[9];
  double to_area, voxel; /* m^2 per m/s of the run's fluid; m */
  /* Largest relative difference of xy and yx etc.; NAN if they are zero by symmetry. */
  double asymmetry;
  int mirrored[3];
};

/* *found is false if the run has no tensor. */
enum status tensor_read(const struct run *run, struct tensor *tensor, bool *found);

/* The tensor as JSON (a new object), and as text; both with sentences on the effect of symmetry on
 * the off-diagonal terms, and of the sample's sides on k. */
json_t *tensor_json(const struct tensor *tensor);
void tensor_summary(const struct tensor *tensor, FILE *stream);

#endif
