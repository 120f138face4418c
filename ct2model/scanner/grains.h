/* Which grain each voxel of a scan belongs to, so that contacts between grains are told from their
 * walls. */
#ifndef TOSUI_CT2MODEL_SCANNER_GRAINS_H
#define TOSUI_CT2MODEL_SCANNER_GRAINS_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Where another grain's voxels begin: along axis d beside the next voxel, or the one before. */
#define GRAINS_NEXT(d) (1U << (d))
#define GRAINS_LAST(d) (8U << (d))

/* contacts[z][y][x]: the bits above. A voxel is grain where share[z][y][x] is above 1/2, and pores
 * within some voxels belong to the grain beside them. The watershed of the distance to the other
 * phase (Beucher and Lantuejoul 1979), in voxels times `stretch` and smoothed over one, from the
 * deepest voxels on; parts that meet at more than 0.7 of the lesser one's depth are one grain. The
 * same on any number of threads, and for a scan that is turned or mirrored. */
enum status grains_find(const float *share, const size_t size[3], const double stretch[3],
                        uint8_t *contacts);

#endif
