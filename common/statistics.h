/* Means with standard errors, fits, histograms. */
#ifndef TOSUI_COMMON_STATISTICS_H
#define TOSUI_COMMON_STATISTICS_H

#include <stddef.h>

#include "common/error.h"

/* Adds a value to a running sum, and its rounding error to `lost`: sum + lost has the relative
 * accuracy of a single rounding for any number of terms (Neumaier 1974, ZAMM 54: 39). */
void add_compensated(double *sum, double *lost, double value);
/* Sum in a fixed order with add_compensated. */
double sum_compensated(const double *values, size_t n);

/* Mean of a correlated series and its standard error by batch means (Flegal, Jones 2010): about
 * sqrt(n) batches; the error is NAN for n < 4. */
void batch_means(const double *values, size_t n, double *mean, double *standard_error);

/* Least squares fit y = a + b x: coefficients, standard errors (NAN for n < 3) and R^2. With
 * `through_origin` a = 0, and R^2 is taken about zero, as usual for a model without intercept. */
struct linear_fit {
  double intercept, slope, intercept_error, slope_error, r_squared;
};
enum status fit_linear(const double *x, const double *y, size_t n, int through_origin,
                       struct linear_fit *fit);

/* Two-sided 95 % quantile of Student's t with `dof` degrees of freedom. */
double student_t95(double dof);

/* Counts of values in `bins` equal bins of [low, high]; those outside are not counted. */
void histogram(const double *values, size_t n, double low, double high, size_t bins,
               double *counts);

/* The q-quantile (0..1) by linear interpolation; works on a copy. NAN for n = 0 or no memory. */
double quantile(const double *values, size_t n, double q);
/* The same, 0 for n = 0, with an error where memory is short; the values are finite. */
enum status quantile_find(const double *values, size_t n, double q, double *result);

#endif
