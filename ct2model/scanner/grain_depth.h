/* Depth of voxels in their grain. */
#ifndef TOSUI_CT2MODEL_SCANNER_GRAIN_DEPTH_H
#define TOSUI_CT2MODEL_SCANNER_GRAIN_DEPTH_H

#include <stddef.h>

#include "common/error.h"

/* Depths in grain and in pore are limited to this, in shortest voxel edges. */
enum { GRAIN_DEEPEST = 250 };

/* depth[z][y][x]: distance to the other phase, in shortest voxel edges (`stretch`: voxel edges over
 * the shortest), negative in pores, smoothed over a voxel. A voxel is grain where share[z][y][x] is
 * above 1/2. Bit-identical for any number of threads. */
enum status grain_depth_find(const float *share, const size_t size[3], const double stretch[3],
                             float *depth);

#endif
