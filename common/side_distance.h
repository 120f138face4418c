/* Wall distances at the sides of a sample that was wrapped, and is to be so no more. */
#ifndef TOSUI_COMMON_SIDE_DISTANCE_H
#define TOSUI_COMMON_SIDE_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>

/* distance[z][y][x] of n, m, negative in grains: wall distances that were found with `axes` (x, y,
 * z) periodic, for a sample that is periodic there no more. A distance longer than the way to the
 * outermost layer of centres on those axes may be that to a wall beyond it. It becomes unknown,
 * INFINITY; or, next to a voxel of the other phase whose own distance is known, the spacing less
 * that distance. In that layer it becomes the distance to where the surface meets the layer. */
void side_distance_unwrap(const size_t n[3], const double spacing[3], const bool axes[3],
                          float *distance);

#endif
