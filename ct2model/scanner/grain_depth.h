/* How deep voxels lie in their grain. */
#ifndef TOSUI_CT2MODEL_SCANNER_GRAIN_DEPTH_H
#define TOSUI_CT2MODEL_SCANNER_GRAIN_DEPTH_H

#include <stddef.h>

#include "common/error.h"

/* No voxel is called deeper than so many voxels, in grain or in pore. */
enum { GRAIN_DEEPEST = 250 };

/* depth[z][y][x]: distances to the other phase, in voxels times `stretch`, below 0 in the pore, and
 * smoothed over a voxel. A voxel is grain where share[z][y][x] is above 1/2. The same bits on any
 * number of threads. */
enum status grain_depth_find(const float *share, const size_t size[3], const double stretch[3],
                             float *depth);

#endif
