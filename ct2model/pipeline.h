/* From the slices to the model: scan (one pass over the pixels), calibrate, binarise, connect,
 * mirror, and the second pass that finds the grain surface. */
#ifndef TOSUI_CT2MODEL_PIPELINE_H
#define TOSUI_CT2MODEL_PIPELINE_H

#include "ct2model/state.h"

/* Runs everything; `distances` off leaves out the wall distances (sweep). `finer`: of the same scan
 * and void ratio, whose scanner is the same; or NULL. Free with pipeline_end. */
enum status pipeline_run(const struct request *request, const char *const *paths, size_t count,
                         bool distances, const struct pipeline *finer, struct pipeline *pipeline);

#endif
