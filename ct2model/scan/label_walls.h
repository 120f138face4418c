/* Smooth walls from labels, instead of the stairs of their voxels. */
#ifndef TOSUI_CT2MODEL_SCAN_LABEL_WALLS_H
#define TOSUI_CT2MODEL_SCAN_LABEL_WALLS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Walls are given as greys from 0, deep in the pores, to this, deep in the grains; the surface is
 * near the middle. */
#define LABEL_GREY 250.0
/* Standard deviation of the narrow filter, in voxels. Of 0, 0.5, 0.7 and 1 it is the one for which
 * k of spheres with radii of 4 to 15 voxels is closest to the exact value
 * (docs/physics/restoration.md). */
#define LABEL_SMOOTHING 0.7
/* Standard deviation of the wide filter, in voxels. */
#define LABEL_SMOOTHING_WIDE 1.6

/* Computes walls[z][y][x] from grain[z][y][x] (1 grain, 0 all else). `reflect`: axes that are
 * mirrored about the first face and the last centre; the others are periodic. Identical for any
 * number of threads. */
enum status label_walls(const uint8_t *grain, const size_t size[3], const bool reflect[3],
                        uint8_t *walls);

#endif
