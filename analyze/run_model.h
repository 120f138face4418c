/* The file of the model that a run solved. */
#ifndef TOSUI_ANALYZE_RUN_MODEL_H
#define TOSUI_ANALYZE_RUN_MODEL_H

#include "analyze/run_file.h"

/* Sets run->model_file: the model as the run names it, or beside the run. Of a file that was
 * changed or replaced since (the run holds the hash), nothing is taken, and a warning says so. */
enum status run_model_find(struct h5_file *file, struct run *run);

#endif
