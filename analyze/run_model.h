/* The file of the model that a run solved. */
#ifndef TOSUI_ANALYZE_RUN_MODEL_H
#define TOSUI_ANALYZE_RUN_MODEL_H

#include <stdbool.h>

#include "common/error.h"
#include "common/hdf5_file.h"

/* *model, in new memory: the path of the model that the run `file` names, as `named`, in `folder`
 * or by its last part there; "" if it is not found. Of a file that was changed or replaced since
 * (the run holds the hash) nothing is taken: *other, and a warning. */
enum status run_model_find(struct h5_file *file, const char *folder, const char *named,
                           char **model, bool *other);

#endif
