/* Darcy's law from runs: permeability with its error. */
#ifndef TOSUI_ANALYZE_DARCY_H
#define TOSUI_ANALYZE_DARCY_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"
#include "analyze/run_file.h"
#include "analyze/averaging.h"

/* A fit of v = k i to runs that may be compared. Errors are 95 % half widths; NAN: unknown. */
struct darcy_fit {
  size_t count;                  /* runs in the fit: those without drift */
  double k, k_error;             /* m/s */
  double intrinsic_permeability; /* m^2 */
  double r_squared;              /* through the origin, about zero; NAN below two runs */
  double free_intercept, free_slope, free_slope_error, free_r_squared; /* v = a + b i */
  bool forchheimer;  /* i = v/k + b v^2 is called for; k is then its k, not the line's */
  double b, b_error; /* s^2/m^2; of that fit, NAN below three runs */
  double curvature;  /* share of i that b v^2 takes at the highest velocity; < 0: k grows */
};

/* velocity and its error95 (m/s) against gradient. `kinematic` (m^2/s) and `gravity` (m/s^2,
 * driving acceleration over hydraulic gradient) give the intrinsic permeability k nu / g. A
 * quadratic term is called for when it is positive, differs from 0 by an F-test at 95 % (the t-test
 * of one parameter) and takes more than 1 % of the highest gradient. */
enum status darcy_fit(const double *gradient, const double *velocity, const double *error95,
                      size_t n, double kinematic, double gravity, struct darcy_fit *fit);

#endif
