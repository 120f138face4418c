/* Number of voxels of the model before mirroring. */
#ifndef TOSUI_CT2MODEL_MODEL_SIZE_H
#define TOSUI_CT2MODEL_MODEL_SIZE_H

#include "ct2model/state.h"

/* Sets pipeline->size from --size, or from the scan; refuses voxels that are far from cubes, and a
 * single slice unless --size asks for it. */
enum status model_size_choose(struct pipeline *pipeline);

#endif
