/* The grain surface as small discs ("surfels"), one in each cell of eight voxel centres that it
 * crosses, and the distance to it.
 *
 * The grey is taken to be linear along the edges of a cell. The centre of its disc is the mean of
 * the crossings on the twelve edges, its normal the gradient there (dual to marching cubes; Gibson
 * 1998). Discs overlap slightly, so that distances near the surface are those to its tangent
 * planes. */
#ifndef TOSUI_CT2MODEL_SURFACE_SURFELS_H
#define TOSUI_CT2MODEL_SURFACE_SURFELS_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* A disc is stored in two words: its place in the block, three times ten bits in units of 1/255 of
 * a cell, and its normal, three times eight bits in units of 1/127. The errors are below 0.006
 * voxels. */
enum { SURFELS_BLOCK = 4 };
#define SURFELS_RADIUS 0.71 /* half the diagonal of a cell's face */

/* Bounding box of the discs of a block, in units of 1/SURFELS_PARTS of a cell, from one cell before
 * the first one of the block; the fourth component is 0. */
enum { SURFELS_PARTS = 40 };
struct surfel_box {
  uint8_t low[4], high[4];
};

/* Lengths are in voxels times `stretch` (1 for cubic voxels); the centre of voxel i lies at
 * (i + 1/2) stretch. The field is periodic in x and y and open in z. */
struct surfels {
  size_t size[3], blocks[3];
  double stretch[3];
  struct surfel_box *boxes; /* of each block of 4x4x4 cells; undefined without a disc */
  uint32_t *first;          /* of each block, index of its first disc; blocks + 1 values */
  uint64_t *occupied;       /* a bit for each block with a disc, `words` words per row */
  size_t words;
  uint32_t *items; /* the places of all discs, then the normals of all discs */
  size_t count;
};

/* Builds the discs from field[z][y][x], positive in the grain, and its bits[z][y][word]
 * (phase_row). Free with surfels_end. */
enum status surfels_build(const int16_t *field, const uint64_t *bits, const size_t size[3],
                          const double stretch[3], struct surfels *surfels);
void surfels_end(struct surfels *surfels);
/* A tile of four by four adjacent points of a lattice, row by row. */
enum { SURFELS_SIDE = 4, SURFELS_POINTS = SURFELS_SIDE * SURFELS_SIDE, SURFELS_MIDDLE = 6 };
struct surfel_points {
  double at[3][SURFELS_POINTS]; /* voxels times `stretch` */
  double distance[SURFELS_POINTS];
};

/* Sets the points to the centres of the lattice cells from `at` on, where a cell spans `factor`
 * voxels; at the end of the lattice the last one is repeated. All distances are set to `limit`. */
void surfel_points_place(const size_t at[3], const size_t size[2], const double factor[3],
                         const double stretch[3], double limit, struct surfel_points *points);
/* Reduces each distance to that of the nearest disc, if that is less. The surface is periodic in x
 * and y and open in z. *near: on entry the block to search first (SURFELS_NOWHERE: any), on return
 * that of the disc nearest to the middle point, or SURFELS_NOWHERE if none is nearer than the
 * initial distance. */
#define SURFELS_NOWHERE SIZE_MAX
void surfels_distances(const struct surfels *surfels, struct surfel_points *points, size_t *near);
/* Limits the distances to `limit` and, along each row, to that of the previous point plus a step,
 * which removes excess from rounded normals. `last`: distance of the point before each row; on
 * return that of its last point. */
void surfel_points_bound(double step, double limit, double last[SURFELS_SIDE],
                         struct surfel_points *points);

#endif
