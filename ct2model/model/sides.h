/* The sides of a model, along the flow: mirrored in x and y, and what its walls are there. */
#ifndef TOSUI_CT2MODEL_MODEL_SIDES_H
#define TOSUI_CT2MODEL_MODEL_SIDES_H

#include <stddef.h>

#include "common/error.h"
#include "common/model_file.h"

/* Spreads data[model z][n y][n x] to data[model z][model y][model x], which has room for it: along
 * an axis on which the model has 2n - 1 voxels, those from n on repeat n - 2 .. 0. */
enum status sides_mirror(const size_t n[3], const struct voxel_model *model, void *data,
                         size_t bytes);
/* The same of data that are spread already, where they stand. */
void sides_repeat(const size_t n[3], const struct voxel_model *model, void *data, size_t bytes);

#endif
