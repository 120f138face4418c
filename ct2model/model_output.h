/* model.hdf: the model with its calibration, quality and provenance. */
#ifndef TOSUI_CT2MODEL_MODEL_OUTPUT_H
#define TOSUI_CT2MODEL_MODEL_OUTPUT_H

#include "common/error.h"
#include "common/options.h"
#include "ct2model/state.h"

/* Writes the pipeline's model to request->output (docs/formats.md), atomically. */
enum status model_output_write(const struct pipeline *pipeline, const struct options *options);

#endif
