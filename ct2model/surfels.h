/* The grain surface as small discs, one for each cell of eight voxel centres that it crosses, and
 * the distance to it.
 *
 * In a cell the grey is taken linear along edges: the disc's centre is the mean of the crossings
 * on the twelve edges, its normal the gradient there (dual to marching cubes; Gibson 1998). Discs
 * overlap a little, so that distances near the surface are those to its tangent planes. */
#ifndef TOSUI_CT2MODEL_SURFELS_H
#define TOSUI_CT2MODEL_SURFELS_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Lengths are in voxels times `stretch` (1 for cubic voxels); the centre of voxel i lies at
 * (i + 1/2) stretch. The field is periodic in x and y and open in z. */
struct surfels {
  size_t size[3], blocks[3];
  double stretch[3];
  uint32_t *first; /* of each block of 4x4x4 cells, in items; blocks + 1 values */
  uint8_t *
      away; /* from each block to the nearest with items, in blocks (largest of x, y, z); 255 far */
  uint32_t *items; /* a word of each disc's place, then, `pitch` further, one of each's normal */
  size_t count, pitch;
};

/* From field[z][y][x], positive in the grain. Free with surfels_end. */
enum status surfels_build(const int16_t *field, const size_t size[3], const double stretch[3],
                          struct surfels *surfels);
void surfels_end(struct surfels *surfels);
/* Distance from `point` to the nearest disc, at most `limit`. Periodic images in x and y are
 * looked at; z is open. */
double surfels_distance(const struct surfels *surfels, const double point[3], double limit);

#endif
