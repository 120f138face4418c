/* Whether a model that repeats itself along an axis fits where it does. */
#ifndef TOSUI_COMMON_CUT_PORES_H
#define TOSUI_COMMON_CUT_PORES_H

#include "common/model_file.h"

/* Share of the pores in the first and the last layer along an axis that meet grain where the model
 * repeats itself; 0 where these layers are no less alike than neighbours are anywhere, as in an
 * image that is periodic. */
double model_cut_pores(const struct voxel_model *model, int axis);

#endif
