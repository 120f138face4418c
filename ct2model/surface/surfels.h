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
 * normal, three times eight bits, to 1/127: errors under 0.006 voxels. */
enum { SURFELS_BLOCK = 4 };
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
  uint32_t *items; /* a word of each disc's place, then one of each's normal */
  size_t count;
};

/* From field[z][y][x], positive in the grain, and its bits[z][y][word] (phase_row). Free with
 * surfels_end. */
enum status surfels_build(const int16_t *field, const uint64_t *bits, const size_t size[3],
                          const double stretch[3], struct surfels *surfels);
void surfels_end(struct surfels *surfels);
/* Four by four points beside each other, row by row: those of a tile of a lattice. */
enum { SURFELS_SIDE = 4, SURFELS_POINTS = SURFELS_SIDE * SURFELS_SIDE, SURFELS_MIDDLE = 6 };
struct surfel_points {
  double at[3][SURFELS_POINTS]; /* voxels times `stretch` */
  double distance[SURFELS_POINTS];
};

/* The centres of the cells from `at` on of a lattice, `factor` voxels each; beyond its `size` the
 * last ones are repeated. All distances are `limit`. */
void surfel_points_place(const size_t at[3], const size_t size[2], const double factor[3],
                         const double stretch[3], double limit, struct surfel_points *points);
/* Each distance becomes that to the nearest disc, if that is less. Periodic images in x and y are
 * looked at; z is open. *near: the block to look at first (SURFELS_NOWHERE: none is better than
 * others) and then that of the disc nearest to the middle point, if it is nearer than before. */
#define SURFELS_NOWHERE SIZE_MAX
void surfels_distances(const struct surfels *surfels, struct surfel_points *points, size_t *near);
/* Along each row no distance is larger than a step more than the one before, and than `limit`: what
 * the rounding of normals adds is cut off. `last`: of each row's point before; then of its last. */
void surfel_points_bound(double step, double limit, double last[SURFELS_SIDE],
                         struct surfel_points *points);

#endif
