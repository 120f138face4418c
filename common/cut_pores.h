/* Whether a model that is treated as periodic along an axis matches at the seam. */
#ifndef TOSUI_COMMON_CUT_PORES_H
#define TOSUI_COMMON_CUT_PORES_H

#include <stdbool.h>

#include "common/model_file.h"

/* Share of the pores in the first and last layers along an axis that face a grain across the
 * periodic boundary. 0 if these two layers differ no more than adjacent layers inside the model do,
 * as in a periodic image. */
double model_cut_pores(const struct voxel_model *model, int axis);

/* Whether the first `layers` along an axis, which were mirrored, are periodic by themselves: their
 * last layer matches their first, and they are not their own mirror image, so that mirroring
 * changed the body. False if the layers do not allow a decision, as with grains two voxels wide. */
bool model_repeats(const struct voxel_model *model, int axis, size_t layers);

#endif
