/* What the error of k is made of: the same split wherever a k is shown. */
#ifndef TOSUI_ANALYZE_UNCERTAINTY_H
#define TOSUI_ANALYZE_UNCERTAINTY_H

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* The parts (common/uncertainty_parts.h). Where a run has no resolution it is what explain
 * expected; averaging has the scatter of a fit; slopes that a run has not solved are those of
 * Kozeny (1927), Carman (1937): d ln k / d e = 3/e - 1/(1+e). */
struct uncertainty {
  union {
    struct {
      UNCERTAINTY_PARTS_MEMBERS
    };
    struct uncertainty_parts parts;
  };
  bool resolution_expected, resolution_index, slope_solved; /* index: of several runs */
  bool scanned; /* the run has a model, and so a share of the scan, known or not */
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
