/* How a run went in time: maximum density, Darcy velocity and whatever columns its scene added. */
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
  bool stationary;          /* a stationary solution: rows are iterations, `times` their numbers */
  struct average average;
  double density_peak; /* highest density_max over the reference, 1.08: 8 %; NAN if unknown */
  double density_mean; /* of the last snapshot over the reference; NAN if unknown */
  struct pdf density;  /* of the last snapshot's density / reference; no bins if all are equal */
};

/* Whether every run has that column, so that it was not added by the scene or method. */
bool history_is_standard(const char *column);
/* Writes the plot of n runs and its size. */
void history_plot(const struct run_history *table, size_t n, struct product *product);

#endif
