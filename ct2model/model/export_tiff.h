/* Exports a voxel model as a TIFF stack, for Fiji and other programs that read images. */
#ifndef TOSUI_CT2MODEL_MODEL_EXPORT_TIFF_H
#define TOSUI_CT2MODEL_MODEL_EXPORT_TIFF_H

#include "common/error.h"
#include "common/model_file.h"

/* Writes `solid` as a multi-page TIFF of 8 bits, one page per layer: 255 grain, 0 pore. The voxel
 * size is given by the resolution tags and, with the layer distance, by ImageJ's description; a
 * model with different spacings in x and y has two resolutions. BigTIFF above 2 GB. Written to a
 * temporary file and renamed. */
enum status export_tiff(const char *path, const struct voxel_model *model);

#endif
