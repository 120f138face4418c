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

/* Terms of the polynomial; the crosses are with the next axis and with the one after it. */
enum { WALK_0, WALK_X, WALK_Y, WALK_Z, WALK_SQUARE, WALK_CROSS_1, WALK_CROSS_2, WALK_TERMS };

/* 128 bytes: two lines of cache. */
struct walk_cell {
  float u[WALK_TERMS][4]; /* along x, y, z, and 0: cells along the axis per time unit */
  float least;            /* distance to the wall of the nearest corner, first spacings */
  int32_t near;           /* whether a wall is in this cell or one of the 26 around it */
  float unused[2];
};

struct walk_cells {
  int n[3];
  int dimensions;
  size_t count;
  struct walk_cell *cell; /* [count], those with pores */
  float (*corner)[8];     /* [count] signed distance to the wall, first spacings; x + 2 y + 4 z */
  int32_t *number;        /* [nz][ny][nx] index into them, -1 for grain */
  int32_t *place;         /* [count] index of its place in the box */
  float stretch[3];       /* first spacing over that along each axis */
  double spacing[3];      /* m */
  double fastest;         /* largest speed on a face, cells per time unit */
  double volume;          /* of the pores, cells */
};

/* The time unit is that in which the mean flow passes the first spacing. `flow` may be freed
 * afterwards. Free with walk_cells_free. */
enum status walk_cells_make(const struct solute_flow *flow, struct walk_cells *cells);
void walk_cells_free(struct walk_cells *cells);

#endif
