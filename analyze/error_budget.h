/* What the error of k is made of: the same split wherever a k is shown. */
#ifndef TOSUI_ANALYZE_ERROR_BUDGET_H
#define TOSUI_ANALYZE_ERROR_BUDGET_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* Relative parts; NAN: unknown. */
struct error_budget {
  double resolution; /* grid convergence index; where a run holds none, what explain expected */
  double scan;       /* blur and noise of the scan */
  double sides;      /* closed, mirrored or wrapped sides of the sample */
  double averaging;  /* over time, and the scatter of a fit */
  double steadiness;
  double void_ratio;       /* the model's void ratio off the measured one */
  double threshold;        /* the threshold's uncertainty */
  double slope_void_ratio; /* d ln k / d e: solved by the run, else after Kozeny (1927), Carman
                            * (1937): 3/e - 1/(1+e) */
  double slope_threshold;  /* d ln k / d T, per grey level: the same over dT/de of the sweep */
  bool resolution_expected, slope_solved;
};

/* From the run and, where it is found, its model file; what is not known stays NAN. */
void error_budget_read(const struct run *run, struct error_budget *budget);

/* Root of the sum of squares of the known parts. */
double error_budget_total(const struct error_budget *budget);

/* For JSON: "error_budget" and the slopes, set in `object`; for people: two lines. */
void error_budget_json(const struct error_budget *budget, json_t *object);
void error_budget_write(const struct error_budget *budget, FILE *stream);

#endif
