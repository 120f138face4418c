/* Runs of different models are not combined unless the user says so. */
#ifndef TOSUI_ANALYZE_COMPATIBLE_RUNS_H
#define TOSUI_ANALYZE_COMPATIBLE_RUNS_H

#include <stdbool.h>

#include "analyze/run_file.h"

/* An input error that names the models and their runs if there is more than one model; with
 * `allowed` an information instead. With `levels` the same body at different spacings counts as one
 * model. */
enum status compatible_runs_check(const struct run *runs, size_t n, bool levels, bool allowed);

/* Whether a and b have the same body: equal size but for rounding to sites. If not, *axis is an
 * axis on which they differ. */
bool compatible_runs_same_body(const struct run *a, const struct run *b, int *axis);

/* Whether a and b have the same model; `levels` as above. */
bool compatible_runs_same_model(const struct run *a, const struct run *b, bool levels);

#endif
