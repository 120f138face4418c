/* The parts of the uncertainty of k, as shown wherever a k is shown. */
#ifndef TOSUI_ANALYZE_UNCERTAINTY_H
#define TOSUI_ANALYZE_UNCERTAINTY_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* The parts (common/uncertainty_parts.h). If the run has no resolution error it is the one expected
 * by explain; `averaging` includes the scatter of a fit; sensitivities that the run has not
 * computed follow from Kozeny (1927), Carman (1937): d ln k / d e = 3/e - 1/(1+e). */
struct uncertainty {
  union {
    struct {
      UNCERTAINTY_PARTS_MEMBERS
    };
    struct uncertainty_parts parts;
  };
  bool resolution_expected, resolution_index, slope_solved; /* index: from several runs */
  bool scanned; /* the run has a model, and so an error of the scan, known or not */
  /* What would reduce the resolution error: "lattice", "model", "scan"; owned by the run. */
  const char *resolution_needs;
};

/* Reads the parts from the run and, if found, its model file; unknown ones are NAN. */
void uncertainty_read(const struct run *run, struct uncertainty *u);

/* Root of the sum of squares of the known parts. */
double uncertainty_total(const struct uncertainty *u);

/* As JSON: "error_budget" and the sensitivities, added to `object`; as text: two lines. */
void uncertainty_json(const struct uncertainty *u, json_t *object);
void uncertainty_write(const struct uncertainty *u, FILE *stream);

#endif
