/* Wall distances near the sides of a sample that is no longer treated as periodic. */
#ifndef TOSUI_COMMON_SIDE_DISTANCE_H
#define TOSUI_COMMON_SIDE_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>

/* Corrects wall distances distance[z][y][x] (m, negative in grains; n voxels along x, y, z), which
 * were computed with `axes` periodic, for a sample that is not periodic along them. A distance
 * longer than that to the outermost layer of voxel centres may be the distance to a wall beyond the
 * side. It becomes unknown (INFINITY) or, next to a voxel of the other phase whose distance is
 * known, the spacing minus that distance. In the outermost layer it becomes the distance, within
 * the layer, to where the surface meets the layer. */
void side_distance_unwrap(const size_t n[3], const double spacing[3], const bool axes[3],
                          float *distance);

#endif
