/* The narrowest place on the widest path through the pores, which controls k. */
#ifndef TOSUI_CT2MODEL_MODEL_CRITICAL_WIDTH_H
#define TOSUI_CT2MODEL_MODEL_CRITICAL_WIDTH_H

#include <stddef.h>

#include "common/error.h"
#include "common/model_file.h"

/* Diameter of the largest ball that can pass along z through the first `layers` of the model, in
 * voxels (of spacing[0]); 0 if none can. */
enum status critical_width_find(const struct voxel_model *model, size_t layers, double *width);

#endif
