/* The narrowest place on the widest way through the pores, which rules k. */
#ifndef TOSUI_CT2MODEL_MODEL_CRITICAL_WIDTH_H
#define TOSUI_CT2MODEL_MODEL_CRITICAL_WIDTH_H

#include <stddef.h>

#include "common/error.h"
#include "common/model_file.h"

/* Diameter of the widest ball that passes through the model along z, in voxels (of spacing[0]), of
 * its first `layers`; 0 where none does. */
enum status critical_width_find(const struct voxel_model *model, size_t layers, double *width);

#endif
