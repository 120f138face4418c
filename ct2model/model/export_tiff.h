/* A voxel model as a TIFF stack, for Fiji and whatever else reads images. */
#ifndef TOSUI_CT2MODEL_MODEL_EXPORT_TIFF_H
#define TOSUI_CT2MODEL_MODEL_EXPORT_TIFF_H

#include "common/error.h"
#include "common/model_file.h"

/* Writes `solid` as a multi-page TIFF of 8 bits, one page a layer: 255 grain, 0 pore. The voxel
 * size stands in the resolution tags and, with the layer distance, in ImageJ's description; a model
 * of unequal spacings in x and y has two resolutions. BigTIFF beyond 2 GB. Written beside and
 * renamed. */
enum status export_tiff(const char *path, const struct voxel_model *model);

#endif
