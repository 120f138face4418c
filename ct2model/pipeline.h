/* From the slices to the model: reading (one pass over the pixels), calibration, binarisation,
 * connectivity, mirroring, and a second pass that finds the grain surface. */
#ifndef TOSUI_CT2MODEL_PIPELINE_H
#define TOSUI_CT2MODEL_PIPELINE_H

#include "ct2model/state.h"

/* Runs all stages; without `distances` (sweep) wall distances are left out. `finer`: a finished
 * pipeline for the same scan and void ratio, whose scanner properties are used; or NULL. Free with
 * pipeline_end. */
enum status pipeline_run(const struct request *request, const char *const *paths, size_t count,
                         bool distances, const struct pipeline *finer, struct pipeline *pipeline);

#endif
