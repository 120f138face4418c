#include "analyze/darcy.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/statistics.h"

/* Errors (95 %) of a fitted line from the errors of its points (95 %), propagated through the least
 * squares. */
static void propagate(const double *x, const double *y_error, size_t n, double *intercept_error,
                      double *slope_error) {
  double mean = 0.0, spread = 0.0, intercept = 0.0, slope = 0.0;
  for (size_t i = 0; i < n; i++) mean += x[i] / (double)n;
  for (size_t i = 0; i < n; i++) spread += (x[i] - mean) * (x[i] - mean);
  for (size_t i = 0; i < n; i++) {
    const double weight = (x[i] - mean) / spread;
    slope += weight * weight * y_error[i] * y_error[i];
    intercept += pow((1.0 / (double)n - mean * weight) * y_error[i], 2.0);
  }
  *intercept_error = sqrt(intercept);
  *slope_error = sqrt(slope);
}

/* Fits i = v / k + b v^2 (Forchheimer 1901, VDI-Z. 45) in the form i/v = 1/k + b v, in which
 * relative residuals have equal weights, so that low gradients count as much as high ones.
 * Student's t is large for few runs (12.7 standard errors for three). Therefore the errors of the
 * runs are used if they explain the residuals, multiplied by the Birge ratio where that is above 1
 * (Birge 1932, Phys. Rev. 40, 207, eq. 4). They do not explain them if the ratio is above 2, which
 * correct errors exceed in one of twenty fits through three runs. */
static enum status fit_forchheimer(const double *gradient, const double *velocity,
                                   const double *error95, size_t n, struct darcy_fit *fit,
                                   double *k, double *k_error) {
  enum status status = STATUS_OK;
  double *resistance = NULL, *resistance_error = NULL;
  struct linear_fit line;
  double fastest = 0.0, residuals = 0.0;
  const double dof = (double)n - 2.0;
  TRY(memory_allocate(&resistance, n, sizeof *resistance, "fit"));
  TRY(memory_allocate(&resistance_error, n, sizeof *resistance_error, "fit"));
  for (size_t i = 0; i < n; i++) {
    resistance[i] = gradient[i] / velocity[i];
    resistance_error[i] = resistance[i] * error95[i] / velocity[i];
    fastest = fmax(fastest, velocity[i]);
  }
  TRY(fit_linear(velocity, resistance, n, 0, &line));
  for (size_t i = 0; i < n; i++) {
    const double residual = resistance[i] - line.intercept - line.slope * velocity[i];
    residuals += pow(residual / (resistance_error[i] / 1.96), 2.0);
  }
  double intercept_error = student_t95(dof) * line.intercept_error;
  double slope_error = student_t95(dof) * line.slope_error;
  const double birge = sqrt(residuals / dof);
  if (birge <= 2.0) { /* false if a run has no error */
    double intercept_own, slope_own;
    propagate(velocity, resistance_error, n, &intercept_own, &slope_own);
    intercept_error = fmin(intercept_error, intercept_own * fmax(1.0, birge));
    slope_error = fmin(slope_error, slope_own * fmax(1.0, birge));
  }
  fit->b = line.slope;
  fit->b_error = slope_error;
  fit->curvature = line.slope * fastest / (line.intercept + line.slope * fastest);
  *k = 1.0 / line.intercept;
  *k_error = intercept_error / (line.intercept * line.intercept);
  fit->forchheimer = line.intercept > 0.0 && fit->b > fit->b_error && fit->curvature > 0.01;
cleanup:
  memory_free(&resistance);
  memory_free(&resistance_error);
  return status;
}

enum status darcy_fit(const double *gradient, const double *velocity, const double *error95,
                      size_t n, double kinematic, double gravity, struct darcy_fit *fit) {
  enum status status = STATUS_OK;
  struct linear_fit line;
  double xx = 0.0, propagated = 0.0;
  bool positive = true, distinct = false;
  *fit = (struct darcy_fit){.count = n,
                            .k_error = NAN,
                            .r_squared = NAN,
                            .free_intercept = NAN,
                            .free_slope = NAN,
                            .free_slope_error = NAN,
                            .free_r_squared = NAN,
                            .b = NAN,
                            .b_error = NAN,
                            .curvature = NAN};
  TRY(fit_linear(gradient, velocity, n, 1, &line));
  fit->k = line.slope;
  for (size_t i = 0; i < n; i++) {
    xx += gradient[i] * gradient[i];
    propagated += gradient[i] * gradient[i] * error95[i] * error95[i];
    positive = positive && velocity[i] > 0.0;
    distinct = distinct || fabs(gradient[i] - gradient[0]) > 1e-9 * fabs(gradient[0]);
  }
  propagated = sqrt(propagated) / xx;
  fit->k_error = propagated;
  if (n >= 2) {
    double scatter = student_t95((double)n - 1.0) * line.slope_error;
    fit->r_squared = line.r_squared;
    fit->k_error = isfinite(propagated) ? fmax(scatter, propagated) : scatter;
  }
  if (n >= 2 && distinct) {
    TRY(fit_linear(gradient, velocity, n, 0, &line));
    fit->free_intercept = line.intercept;
    fit->free_slope = line.slope;
    fit->free_slope_error = student_t95((double)n - 2.0) * line.slope_error;
    fit->free_r_squared = line.r_squared;
  }
  if (n >= 3 && distinct && positive) {
    double k, k_error;
    TRY(fit_forchheimer(gradient, velocity, error95, n, fit, &k, &k_error));
    if (fit->forchheimer) {
      fit->k = k;
      fit->k_error = fmax(k_error, isfinite(propagated) ? propagated : 0.0);
    }
  }
  fit->intrinsic_permeability = fit->k * kinematic / gravity;
cleanup:
  return status;
}
