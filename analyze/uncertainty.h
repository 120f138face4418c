/* What the error of k is made of: the same split wherever a k is shown. */
#ifndef TOSUI_ANALYZE_UNCERTAINTY_H
#define TOSUI_ANALYZE_UNCERTAINTY_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* Relative parts; NAN: unknown. */
struct uncertainty {
  double resolution; /* from several lattices; where a run has none, what explain expected */
  double scan;       /* blur and noise of the scan */
  double sides;      /* closed, mirrored or wrapped sides of the sample */
  double averaging;  /* over time, and the scatter of a fit */
  double steadiness;
  double void_ratio;       /* the model's void ratio off the measured one */
  double threshold;        /* the threshold's uncertainty */
  double slope_void_ratio; /* d ln k / d e: solved by the run, else after Kozeny (1927), Carman
                            * (1937): 3/e - 1/(1+e) */
  double slope_threshold;  /* d ln k / d T, per grey level: the same over dT/de of the sweep */
  double sides_closed;     /* ln k in a tube that the sample fills, less ln k */
  bool resolution_expected, resolution_index, slope_solved; /* index: of several runs */
  const char *resolution_needs; /* what lessens its share: "lattice", "model", "scan"; of the run */
};

/* From the run and, where it is found, its model file; what is not known stays NAN. */
void uncertainty_read(const struct run *run, struct uncertainty *u);

/* Root of the sum of squares of the known parts. */
double uncertainty_total(const struct uncertainty *u);

/* For JSON: "error_budget" and the slopes, set in `object`; for people: two lines. */
void uncertainty_json(const struct uncertainty *u, json_t *object);
void uncertainty_write(const struct uncertainty *u, FILE *stream);

#endif
