/* The grain surface as small discs, one for each cell of eight voxel centres that it crosses, and
 * the distance to it.
 *
 * In a cell the grey is taken linear along edges: the disc's centre is the mean of the crossings
 * on the twelve edges, its normal the gradient there (dual to marching cubes; Gibson 1998). Discs
 * overlap a little, so that distances near the surface are those to its tangent planes. */
#ifndef TOSUI_CT2MODEL_SURFACE_SURFELS_H
#define TOSUI_CT2MODEL_SURFACE_SURFELS_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* A disc is two words: its place in the block, three times ten bits, to 1/255 of a cell, and its
 * normal, three times eight bits, to 1/127: errors under 0.006 voxels. Whole vectors are read. */
enum { SURFELS_BLOCK = 4, SURFELS_LANES = 16 };
#define SURFELS_RADIUS 0.71 /* half the diagonal of a cell's face */

/* What the discs of a block lie within, in parts of a cell from one cell before the block's first
 * on; the fourth is 0. */
enum { SURFELS_PARTS = 40 };
struct surfel_box {
  uint8_t low[4], high[4];
};

/* Lengths are in voxels times `stretch` (1 for cubic voxels); the centre of voxel i lies at
 * (i + 1/2) stretch. The field is periodic in x and y and open in z. */
struct surfels {
  size_t size[3], blocks[3];
  double stretch[3];
  struct surfel_box *boxes; /* of each block of 4x4x4 cells; any where it holds no disc */
  uint32_t *first;          /* of each block, in items; blocks + 1 values */
  uint64_t *occupied;       /* blocks with a disc: a bit each, `words` a row */
  size_t words;
  uint32_t *items; /* a word of each disc's place, then, `pitch` further, one of each's normal */
  size_t count, pitch;
};

/* From field[z][y][x], positive in the grain, and its bits[z][y][word] (phase_row). Free with
 * surfels_end. */
enum status surfels_build(const int16_t *field, const uint64_t *bits, const size_t size[3],
                          const double stretch[3], struct surfels *surfels);
void surfels_end(struct surfels *surfels);
/* Distance from `point` to the nearest disc, at most `limit`. Periodic images in x and y are
 * looked at; z is open. *near: the block to look at first (SURFELS_NOWHERE: none is better than
 * others) and then that of the nearest disc, if it is nearer than `limit`. */
#define SURFELS_NOWHERE SIZE_MAX
double surfels_distance(const struct surfels *surfels, const double point[3], double limit,
                        size_t *near);

#endif
