/* The permeability tensor that sphsolve run --tensor keeps in its record (/run/tensor). */
#ifndef TOSUI_ANALYZE_TENSOR_H
#define TOSUI_ANALYZE_TENSOR_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "analyze/run_file.h"

struct tensor {
  double k[9], low[9], high[9]; /* m/s, 95 %; row: flow along x, y, z, column: gradient */
  double principal[3], principal_low[3], principal_high[3]; /* m/s, largest first */
  double axes[9];                                           /* their unit vectors, one a row */
  double to_area, voxel;                                    /* m^2 per m/s of the run's fluid; m */
  double asymmetry; /* NAN: all terms off the diagonal are zero by symmetry */
  int mirrored[3];
};

/* *found is false where the run has none. */
enum status tensor_read(const struct run *run, struct tensor *tensor, bool *found);

/* The tensor as JSON (a new object), as lines for people, and as tables of HTML. */
json_t *tensor_json(const struct tensor *tensor);
void tensor_summary(const struct tensor *tensor, FILE *stream);
void tensor_html(const struct tensor *tensor, FILE *stream);

#endif
