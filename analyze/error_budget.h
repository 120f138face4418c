/* What the error of k is made of, beside what averaging and fit show. */
#ifndef TOSUI_ANALYZE_ERROR_BUDGET_H
#define TOSUI_ANALYZE_ERROR_BUDGET_H

#include "analyze/run_file.h"

/* Relative parts; NAN: unknown. */
struct error_budget {
  double resolution;       /* as sphsolve expected it of the run's spacing */
  double void_ratio;       /* by the model's void ratio off the measured one */
  double slope_void_ratio; /* d ln k / d e, after Kozeny (1927), Carman (1937): 3/e - 1/(1+e) */
  double slope_threshold;  /* d ln k / d T, per grey level: the same over dT/de of the sweep */
};

/* From the run and, where it is found, its model file; what is not known stays NAN. */
void error_budget_read(const struct run *run, struct error_budget *budget);

/* Root of the sum of squares of `statistical` and the known parts. */
double error_budget_total(const struct error_budget *budget, double statistical);

#endif
