/* Whether a model that repeats itself along an axis fits where it does. */
#ifndef TOSUI_COMMON_CUT_PORES_H
#define TOSUI_COMMON_CUT_PORES_H

#include <stdbool.h>

#include "common/model_file.h"

/* Share of the pores in the first and the last layer along an axis that meet grain where the model
 * repeats itself; 0 where these layers are no less alike than neighbours are anywhere, as in an
 * image that is periodic. */
double model_cut_pores(const struct voxel_model *model, int axis);

/* Whether the first `layers` along an axis, which were mirrored, repeat themselves as they stand:
 * their last fits their first, and they are not their own image, so that mirrored they are another
 * body. False where layers tell nothing, as of grains two voxels wide. */
bool model_repeats(const struct voxel_model *model, int axis, size_t layers);

#endif
