/* Mirrors a model at its sides along the flow, in x and y. */
#ifndef TOSUI_CT2MODEL_MODEL_SIDES_H
#define TOSUI_CT2MODEL_MODEL_SIDES_H

#include <stddef.h>

#include "common/error.h"
#include "common/model_file.h"

/* Extends data[model z][n y][n x] to data[model z][model y][model x] in place, for which there is
 * room: along an axis on which the model has 2n - 1 voxels, those from n on repeat n - 2 .. 0.
 * `bytes`: size of a value. */
enum status sides_mirror(const size_t n[3], const struct voxel_model *model, void *data,
                         size_t bytes);
/* The same for data that already have the size of the model. */
void sides_repeat(const size_t n[3], const struct voxel_model *model, void *data, size_t bytes);

#endif
