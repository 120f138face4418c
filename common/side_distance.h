/* Sides of a sample: wall distances near those that are no longer treated as periodic, and whether
 * a model that is treated as periodic along an axis matches at the seam. */
#ifndef TOSUI_COMMON_SIDE_DISTANCE_H
#define TOSUI_COMMON_SIDE_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/model_file.h"

/* Corrects wall distances distance[z][y][x] (m, negative in grains; n voxels along x, y, z), which
 * were computed with `axes` periodic, for a sample that is not periodic along them. A distance
 * longer than that to the outermost layer of voxel centres may be the distance to a wall beyond the
 * side. It becomes unknown (INFINITY) or, next to a voxel of the other phase whose distance is
 * known, the spacing minus that distance. In the outermost layer it becomes the distance, within
 * the layer, to where the surface meets the layer. */
void side_distance_unwrap(const size_t n[3], const double spacing[3], const bool axes[3],
                          float *distance);

/* Share of the pores in the first and last layers along an axis that face a grain across the
 * periodic boundary. 0 if these two layers differ no more than adjacent layers inside the model do,
 * as in a periodic image. */
double model_cut_pores(const struct voxel_model *model, int axis);

/* Whether the first `layers` along an axis, which were mirrored, are periodic by themselves: their
 * last layer matches their first, and they are not their own mirror image, so that mirroring
 * changed the body. False if the layers do not allow a decision, as with grains two voxels wide. */
bool model_repeats(const struct voxel_model *model, int axis, size_t layers);

#endif
