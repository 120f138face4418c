/* The result of a run on stdout. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_RUN_PRINT_H
#define TOSUI_SPHSOLVE_OUTPUT_RUN_PRINT_H

#include "common/error.h"
#include "sphsolve/output/recorder.h"

/* Prints one JSON object. */
enum status run_print_json(const struct run_result *result);
/* Prints text: k with its error, a verdict, the budget; more with -v. `prefix`: of the files;
 * `wanted`: requested relative error, or INFINITY; `scanned`: k is that of a voxel model and has an
 * error due to the scan, known or not. */
void run_print(const struct run_result *result, const char *prefix, double wanted, bool scanned);

#endif
