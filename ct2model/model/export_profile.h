/* Porosity and pore width from layer to layer along x, y and z, and the widths' distribution. */
#ifndef TOSUI_CT2MODEL_MODEL_EXPORT_PROFILE_H
#define TOSUI_CT2MODEL_MODEL_EXPORT_PROFILE_H

#include "common/error.h"
#include "common/model_file.h"

/* CSV: a row for each layer along x, y and z (`axis`), where its middle is (m), its porosity (by
 * grain fractions where the model has them) and the mean width of its pores (m; local thickness,
 * the largest ball that fits; empty where no pore is, or without wall distances). Then rows of
 * axis "width": the width (m, the middle of a bin of a voxel), and the share of the pores in it. */
enum status export_profile(const char *path, const struct voxel_model *model);

#endif
