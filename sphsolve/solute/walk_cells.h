/* The flow for random walkers: in every cell a velocity that varies with the position and is
 * divergence-free everywhere, and the wall as the surface where the distance is 0.
 *
 * Velocity (Balsara 2001, J. Comput. Phys. 174, 614, there for magnetic fields): on each face the
 * flux varies linearly; within a cell of -1/2 <= x, y, z <= 1/2
 *   u = a0 + ax x + ay y + az z + axx x^2 + axy x y + axz x z,   v and w likewise,
 * is the polynomial that takes these values on the six faces and whose divergence is 0 at every
 * point. Without the slopes it is the interpolation of Pollock (1988). The normal velocity is
 * continuous across faces, and nothing crosses a closed face.
 *
 * In a cell cut by the wall this flow fills the whole cube, including the grain; walk_move.h
 * explains why walkers that follow it stay uniformly distributed over the pore. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_CELLS_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_CELLS_H

#include <stdint.h>

#include "common/error.h"
#include "sphsolve/solute/flow.h"

/* x, y, z and one more: the four lanes of the smallest vector register. */
typedef float walk_vector __attribute__((vector_size(16)));
typedef int32_t walk_place __attribute__((vector_size(16)));

/* One cache line. Slopes and distances are stored as integers in units of the whole lattice
 * (slope_unit, distance_unit), so that the cells on both sides of a face or a corner have identical
 * values: rounding a slope leaves the divergence 0. Four values are read at once, even where three
 * are needed; the fourth is then the next value, which is finite and not used. */
struct walk_cell {
  int16_t corner[8];   /* signed distance of the corners to the wall; x + 2 y + 4 z */
  int16_t slope[4][3]; /* of the flux through the low faces along x, y, z towards the next axis and
                          towards the one after it; then of the high faces */
  float face[2][3];    /* flux through the low and the high faces, cells along the axis per time
                          unit */
};

/* 4 x 4 x 4 cells, one bit each: x + 4 y + 16 z. */
struct walk_brick {
  uint64_t open;  /* cells with pores */
  uint64_t near;  /* cells with a wall in them or in one of the 26 cells around */
  uint64_t cut;   /* cells with a corner in grain */
  uint32_t first; /* number of the first open cell; the others follow in order of their bits */
  uint32_t unused;
};

struct walk_cells {
  int n[3];
  int blocks[3]; /* number of blocks along the axes, of 4 x 4 x 4 bricks each */
  int dimensions;
  size_t count;             /* cells with pores */
  size_t bricks;            /* blocks x 64 */
  struct walk_cell *cell;   /* [count] in order of brick and bit */
  struct walk_brick *brick; /* [bricks] in order of block, within it x + 4 y + 16 z */
  int32_t *place;           /* [count] index of the cell in the box */
  float slope_unit;         /* unit of the slopes, cells per time unit */
  float distance_unit;      /* unit of the distances, first spacings */
  float stretch[3];         /* first spacing over the spacing along each axis */
  double spacing[3];        /* m */
  double volume;            /* pore volume, cells */
};

/* Address of a cell of the box: brick x 64 + bit; lane 3 of `x` is 0. */
static inline uint32_t walk_address(const struct walk_cells *c, walk_place x) {
  const walk_place block = {1 << 12, c->blocks[0] << 12, c->blocks[0] * c->blocks[1] << 12, 0};
  const walk_place brick = {1 << 6, 1 << 8, 1 << 10, 0}, bit = {1, 4, 16, 0};
  const walk_place sum = (x >> 4) * block + (x >> 2 & 3) * brick + (x & 3) * bit;
  return (uint32_t)(sum[0] + sum[1] + sum[2]);
}

/* Prepares the cells. The time unit is the time in which the mean flow passes the first spacing.
 * `flow` may be freed afterwards. Free with walk_cells_free. */
enum status walk_cells_make(const struct solute_flow *flow, struct walk_cells *cells);
void walk_cells_free(struct walk_cells *cells);

#endif
