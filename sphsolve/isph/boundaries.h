/* What bounds the water of method isph: walls and the tank, windows and the columns behind them. */
#ifndef TOSUI_SPHSOLVE_ISPH_BOUNDARIES_H
#define TOSUI_SPHSOLVE_ISPH_BOUNDARIES_H

#include <stdbool.h>
#include <stddef.h>

#include "sphsolve/scene/scene.h"

/* A box of wall, or the tank around the domain (inverted). */
struct isph_wall_box {
  double low[3], high[3];
  double mirror_low[3], mirror_high[3]; /* the same, but without end where a polygon goes on */
  double velocity[3];
  const struct region *region; /* NULL: the tank */
  bool slip, tank;
};

enum boundary_kind { BOUNDARY_WALL, BOUNDARY_OPEN_HEAD, BOUNDARY_OPEN_FLUX };

/* A window in a side of the domain through which water comes and goes. */
struct isph_open_side {
  int axis;               /* of its normal */
  double inward;          /* +1: on the low side, -1: on the high side */
  double edge;            /* where on the axis */
  double low[3], high[3]; /* rectangle on the side; equal along `axis` */
  enum boundary_kind kind;
  const struct region *region;
  double head, flux;  /* now */
  double velocity[3]; /* of its boundary particles, where the flux is given */
  int cells[3];       /* columns across the rectangle */
  double pitch[3];    /* their widths; along `axis` the spacing of free water */
  double porosity;    /* of the soil there, by its sharp edge */
  size_t first;       /* of its columns; those above the head are there, but dry */
};

/* A file of boundary particles behind one cell of a window, that moves with the water. */
struct isph_column {
  size_t side, first; /* first of its boundary particles */
  double pitch;       /* of its particles, along the axis */
  double volume;      /* of each */
  bool dry;           /* above the head: air, and no particles */
  double at[3];       /* its axis on the side */
  double speed;       /* of the water there, inward: of the pores */
};

/* Of a periodic or a closed side: x' = turn x + shift. */
struct isph_image {
  double turn[3], shift[3]; /* turn: -1 along the normals of the sides that reflect, else 1 */
  bool reflected;
};

#define BEHIND_STEPS 16
#define BEHIND (8 * BEHIND_STEPS)

#define WALL_NEAREST 0.25 /* of a spacing: bounds the viscous pull of a particle that touches */

#endif
