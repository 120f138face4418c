/* Where a history becomes steady, and the mean after that point with its error. */
#ifndef TOSUI_ANALYZE_STEADY_H
#define TOSUI_ANALYZE_STEADY_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/run_file.h"

struct steady {
  size_t first, rows;    /* rows averaged: first .. first + rows - 1 */
  double from_time;      /* s */
  double mean;           /* unit of the series */
  double standard_error; /* by batch means; NAN for fewer than 4 rows */
  double drift;          /* mean of the window's second half minus that of its first */
  double error95;        /* 95 %: the larger of t * standard error and |drift| */
  bool is_steady;        /* |drift| <= 5 % of the mean, or for method stokes k_error <= 5 % */
};

/* The steady point by the marginal standard error rule (White 1997, Simulation 69, 323): the
 * number of rows to drop that minimises the variance of the remaining mean. Rows that are not
 * evenly spaced in time are first resampled. At least a tenth of the rows (and 5) is kept. */
enum status steady_find(const double *times, const double *values, size_t n, struct steady *steady);

/* Darcy velocity of a run along its driving force: for method stokes the one converged value with
 * the run's own k_error, else the steady mean of its history. */
enum status steady_darcy(const struct run *run, struct steady *steady);

#endif
