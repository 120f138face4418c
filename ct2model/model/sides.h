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

/* Distances that were found with the opposite side for a neighbour: those that reach beyond a side
 * (x or y) become unknown, INFINITY, or where the other phase is next to a voxel, what is left of
 * the way between the two. distance[z][y][x] of n. */
void sides_forget(const size_t n[3], const double spacing[3], float *distance);

#endif
