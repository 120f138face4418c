/* History of a run: maximum density, Darcy velocity and further columns that its scene records. */
#ifndef TOSUI_ANALYZE_HISTORY_H
#define TOSUI_ANALYZE_HISTORY_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/pdf.h"
#include "analyze/product.h"
#include "analyze/run_file.h"
#include "analyze/averaging.h"

struct run_history {
  const struct run *run;
  size_t rows;
  double *times, *velocity; /* velocity along the driving force */
  bool stationary;          /* stationary solution: rows are iterations, `times` their numbers */
  struct average average;
  /* Highest density_max over the reference density, 1.08 for 8 %; NAN: unknown. */
  double density_peak;
  double density_mean; /* mean of the last snapshot over the reference density; NAN: unknown */
  /* Distribution of density / reference in the last snapshot; no bins if all are equal. */
  struct pdf density;
};

#endif
