/* Assigns the voxels of a scan to grains, to distinguish the contacts between grains from their
 * walls. */
#ifndef TOSUI_CT2MODEL_SCANNER_GRAINS_H
#define TOSUI_CT2MODEL_SCANNER_GRAINS_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Bits of a voxel whose neighbour along axis d, the next or the previous one, belongs to another
 * grain. */
#define GRAINS_NEXT(d) (1U << (d))
#define GRAINS_LAST(d) (8U << (d))

/* contacts[z][y][x]: the bits above. A voxel is grain where share[z][y][x] is above 1/2; pores
 * within some voxels of a grain are assigned to it. The grains are found by the watershed of the
 * distance to the other phase (Beucher and Lantuejoul 1979), in shortest voxel edges and smoothed
 * over one; parts that meet at more than 0.7 of the depth of the shallower one are one grain. The
 * result does not depend on the number of threads, or on turning or mirroring the scan. */
enum status grains_find(const float *share, const size_t size[3], const double stretch[3],
                        uint8_t *contacts);

#endif
