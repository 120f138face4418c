/* How many voxels the model has before it is mirrored. */
#ifndef TOSUI_CT2MODEL_MODEL_SIZE_H
#define TOSUI_CT2MODEL_MODEL_SIZE_H

#include "ct2model/state.h"

/* pipeline->size from --size, or from the scan; refuses voxels that are too far from cubes, and one
 * slice unless it is asked for. */
enum status model_size_choose(struct pipeline *pipeline);

#endif
