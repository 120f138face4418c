/* The flow as random walkers see it: in every cell a velocity that varies with the place and has no
 * divergence anywhere, and the wall as the surface where the distance is 0.
 *
 * Velocity (Balsara 2001, J. Comput. Phys. 174, 614, there for magnetic fields): on each face the
 * flux varies linearly; within a cell of -1/2 <= x, y, z <= 1/2
 *   u = a0 + ax x + ay y + az z + axx x^2 + axy x y + axz x z,   v and w likewise,
 * is the polynomial that takes these values on the six faces and whose divergence is 0 at every
 * point. Without the slopes it is the interpolation of Pollock (1988). What leaves a cell enters
 * the next, and nothing crosses a closed face.
 *
 * In a cell that the wall cuts, this flow fills all of the cube, grain too; see walk_move.h for why
 * walkers that follow it still stay evenly spread over the pore. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_CELLS_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_CELLS_H

#include <stdint.h>

#include "common/error.h"
#include "sphsolve/solute/flow.h"

/* x, y, z and one more: the four lanes of the smallest vector register. */
typedef float walk_vector __attribute__((vector_size(16)));
typedef int32_t walk_place __attribute__((vector_size(16)));

/* One line of cache. Slopes and distances are counted in units of the cells (walk_cells.unit), so
 * that the cells on both sides of a face or a corner have the same: rounding a slope leaves the
 * divergence 0. Four lanes are read at once, also where three are meant: the fourth is the next
 * value, of no use and finite. */
struct walk_cell {
  int16_t corner[8];   /* signed distance of the corners to the wall; x + 2 y + 4 z */
  int16_t slope[4][3]; /* of the flux through the low faces along x, y, z towards the next axis and
                          towards the one after it; then of the high faces */
  float face[2][3];    /* flux through the low and the high faces, cells along the axis per time
                          unit */
};

/* 4 x 4 x 4 cells, a bit each: x + 4 y + 16 z. */
struct walk_brick {
  uint64_t open;  /* with pores */
  uint64_t near;  /* with a wall in it, or in one of the 26 cells around it */
  uint64_t cut;   /* with a corner in grain */
  uint32_t first; /* number of the first open cell; the others follow by bit */
  uint32_t unused;
};

struct walk_cells {
  int n[3];
  int blocks[3]; /* of 4 x 4 x 4 bricks each, so many along the axes */
  int dimensions;
  size_t count;             /* cells with pores */
  size_t bricks;            /* blocks x 64 */
  struct walk_cell *cell;   /* [count] by brick and bit */
  struct walk_brick *brick; /* [bricks] by block, in it x + 4 y + 16 z */
  int32_t *place;           /* [count] index of the cell's place in the box */
  float slope_unit;         /* cells per time unit */
  float distance_unit;      /* first spacings */
  float stretch[3];         /* first spacing over that along each axis */
  double spacing[3];        /* m */
  double volume;            /* of the pores, cells */
};

/* Brick x 64 + bit of a cell of the box; lane 3 of `x` is 0. */
static inline uint32_t walk_address(const struct walk_cells *c, walk_place x) {
  const walk_place block = {1 << 12, c->blocks[0] << 12, c->blocks[0] * c->blocks[1] << 12, 0};
  const walk_place brick = {1 << 6, 1 << 8, 1 << 10, 0}, bit = {1, 4, 16, 0};
  const walk_place sum = (x >> 4) * block + (x >> 2 & 3) * brick + (x & 3) * bit;
  return (uint32_t)(sum[0] + sum[1] + sum[2]);
}

/* The time unit is that in which the mean flow passes the first spacing. `flow` may be freed
 * afterwards. Free with walk_cells_free. */
enum status walk_cells_make(const struct solute_flow *flow, struct walk_cells *cells);
void walk_cells_free(struct walk_cells *cells);

#endif
