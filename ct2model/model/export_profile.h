/* Porosity and pore width by layer along x, y and z, and the distribution of widths. */
#ifndef TOSUI_CT2MODEL_MODEL_EXPORT_PROFILE_H
#define TOSUI_CT2MODEL_MODEL_EXPORT_PROFILE_H

#include "common/error.h"
#include "common/model_file.h"

/* Writes a CSV file: a row for each layer along x, y and z (`axis`), with the position of its
 * middle (m), its porosity (from grain fractions if the model has them) and the mean width of its
 * pores (m; local thickness, the diameter of the largest ball that fits; empty where there is no
 * pore or no wall distance). Then rows with axis "width": the width (m, the middle of a bin of one
 * voxel), and the fraction of the pores in that bin. */
enum status export_profile(const char *path, const struct voxel_model *model);

#endif
