/* The file of the model of a run. */
#ifndef TOSUI_ANALYZE_RUN_MODEL_H
#define TOSUI_ANALYZE_RUN_MODEL_H

#include <stdbool.h>

#include "common/error.h"
#include "common/hdf5_file.h"

/* Finds the model that the run `file` names `named`: under that path, in `folder`, or by its last
 * component in `folder`. *model, in new memory, is its path, or "" if it is not found. A file that
 * has changed since the run (by its hash) is not used: *other is then set, with a warning. */
enum status run_model_find(struct h5_file *file, const char *folder, const char *named,
                           char **model, bool *other);

#endif
