/* Runs of different models are not shown together unless the user says so. */
#ifndef TOSUI_ANALYZE_COMPATIBLE_RUNS_H
#define TOSUI_ANALYZE_COMPATIBLE_RUNS_H

#include <stdbool.h>

#include "analyze/run_file.h"

/* An input error naming the models and their runs where the runs are of more than one; with `told`
 * the same as a line of information. With `levels`, one body at different spacings is one model. */
enum status compatible_runs_check(const struct run *runs, size_t n, bool levels, bool told);

/* Whether a and b show one body: its size may differ by rounding to sites, not more. *axis: where
 * it does not. */
bool compatible_runs_same_body(const struct run *a, const struct run *b, int *axis);

/* Whether a and b are of one model; with `levels`, as above. */
bool compatible_runs_same_model(const struct run *a, const struct run *b, bool levels);

#endif
