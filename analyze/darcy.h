/* Permeability with its error by Darcy's law, from several runs. */
#ifndef TOSUI_ANALYZE_DARCY_H
#define TOSUI_ANALYZE_DARCY_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"
#include "analyze/run_file.h"
#include "analyze/averaging.h"

/* A fit of v = k i to comparable runs. Errors are 95 % half widths; NAN: unknown. */
struct darcy_fit {
  size_t count;                  /* runs in the fit: those without drift */
  double k, k_error;             /* m/s */
  double intrinsic_permeability; /* m^2 */
  /* Of the fit through the origin, about zero; NAN with fewer than two runs. */
  double r_squared;
  double free_intercept, free_slope, free_slope_error, free_r_squared; /* of the line v = a + b i */
  /* The term b v^2 of i = v/k + b v^2 is significant; k is then that of this fit. */
  bool forchheimer;
  double b, b_error; /* s^2/m^2, of that fit; NAN with fewer than three runs */
  /* Share of i due to b v^2 at the highest velocity; negative if k grows with i. */
  double curvature;
};

/* Fits `velocity`, with errors `error95` (95 %; both m/s), against the hydraulic gradient. The
 * kinematic viscosity (m^2/s) and `gravity` (m/s^2, driving acceleration over hydraulic gradient)
 * give the intrinsic permeability k nu / g. The quadratic term is used if it is positive,
 * significant by an F-test at 95 % (the t-test of one parameter) and contributes more than 1 % of
 * the highest gradient. */
enum status darcy_fit(const double *gradient, const double *velocity, const double *error95,
                      size_t n, double kinematic, double gravity, struct darcy_fit *fit);

#endif
