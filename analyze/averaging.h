/* The mean of a recorded series after its start-up, with its error, and whether the averaged rows
 * still drift. This judges rows that are there; how far the flow is from where it goes, the part
 * `steadiness` of a k's error, is found by the run itself (sphsolve/march/monitor.h). */
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
  double drift;          /* mean of the window's second half minus that of its first */
  double error95;        /* 95 %: the larger of t * standard error and |drift| */
  bool without_drift;    /* |drift| <= 5 % of the mean; of method stokes k_error <= 5 % */
};

/* The end of the start-up by the marginal standard error rule (White 1997, Simulation 69, 323): the
 * number of rows to drop that minimises the variance of the remaining mean. Rows that are not
 * evenly spaced in time are first resampled. At least a tenth of the rows (and 5) is kept. */
enum status average_record(const double *times, const double *values, size_t n,
                           struct average *average);

/* Darcy velocity of a run along its driving force: 0 where no pore leads through, for method stokes
 * the one converged value with the run's own k_error, for isph that of the second half with the
 * run's own error, else the mean of its history after the start-up. */
enum status average_darcy(const struct run *run, struct average *average);

#endif
