/* Mean of a recorded series after its start-up, its error, and whether the averaged rows still
 * drift. This concerns the recorded rows; the distance of the flow from its final state, the part
 * `steadiness` of the error of k, is estimated by the run itself (sphsolve/march/monitor.h). */
#ifndef TOSUI_ANALYZE_AVERAGING_H
#define TOSUI_ANALYZE_AVERAGING_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/run_file.h"

struct average {
  size_t first, rows;    /* rows averaged: first .. first + rows - 1 */
  double from_time;      /* s */
  double mean;           /* unit of the series */
  double standard_error; /* by batch means; NAN for fewer than 4 rows */
  double drift;          /* mean of the second half of the window minus that of its first half */
  double error95;        /* 95 %: the larger of t * standard error and |drift| */
  /*
   * drift
   *  <= 5 % of the mean; for method stokes k_error <= 5 %. */
  bool without_drift;
};

/* Determines the end of the start-up by the marginal standard error rule (White 1997, Simulation
 * 69, 323): the number of rows to drop that minimises the variance of the mean of the rest. Rows at
 * uneven times are first resampled. At least a tenth of the rows, and 5 of them, are kept. */
enum status average_record(const double *times, const double *values, size_t n,
                           struct average *average);

/* Darcy velocity of a run along its driving force: 0 if no pore leads through; for methods
 * stokes and darcy the value solved for with the run's k_error; else the mean of the history after
 * the start-up. */
enum status average_darcy(const struct run *run, struct average *average);

#endif
