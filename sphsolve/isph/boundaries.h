/* Boundaries of the water in method isph: walls, the tank around the domain, and open sides
 * (windows). */
#ifndef TOSUI_SPHSOLVE_ISPH_BOUNDARIES_H
#define TOSUI_SPHSOLVE_ISPH_BOUNDARIES_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "sphsolve/scene/scene.h"

/* A box of wall, or the tank: the outside of the domain's box. */
struct isph_wall_box {
  double low[3], high[3];
  /* as low and high, but infinite where a polygon continues in another box */
  double mirror_low[3], mirror_high[3];
  double velocity[3];
  const struct region *region;   /* NULL: the tank */
  const struct polygon *outline; /* NULL: it is a box; isph/outline.h */
  bool slip, tank;
};

enum boundary_kind { BOUNDARY_WALL, BOUNDARY_OPEN_HEAD, BOUNDARY_OPEN_FLUX };

/* A window in a side of the domain through which water comes and goes. */
struct isph_open_side {
  int axis;               /* of its normal */
  double inward;          /* +1: on the low side, -1: on the high side */
  double edge;            /* its coordinate on the axis, m */
  double low[3], high[3]; /* corners of the rectangle on the side; equal along `axis` */
  enum boundary_kind kind;
  const struct region *region;
  double head, flux;  /* at the end of the present step */
  double given;       /* head or flux that the scene gives; of a head see isph/radiation.h */
  double velocity[3]; /* velocity of its boundary particles if the flux is given */
  int cells[3];       /* columns across the rectangle */
  double pitch[3];    /* widths of the columns; along `axis` the spacing of free water */
  double porosity;    /* of the soil there, taking its edge as sharp; 1: none */
  size_t first;       /* index of its first column; those above the head are included, but dry */
};

/* A row of boundary particles behind one cell of a window, normal to it, which moves with the
 * water. */
struct isph_column {
  size_t side, first; /* first of its boundary particles */
  double pitch;       /* spacing of its particles along the axis, m */
  double volume;      /* bulk volume of each particle */
  bool dry;           /* above the head: there is air instead of particles */
  double at[3];       /* where its axis meets the side, m */
  double speed;       /* inward pore velocity of the water there, m/s */
  double water;       /* kernel sum of the water there, of a side of given head */
};

/* Image of a point x across periodic or reflecting sides: x' = turn x + shift. */
struct isph_image {
  double turn[3], shift[3]; /* turn: -1 along the normals of the sides that reflect, else 1 */
  bool reflected;
};

#define BEHIND_STEPS 16
#define BEHIND (8 * BEHIND_STEPS)

/* in spacings: least distance of a particle from a wall in the mirror ratio, which bounds the
 * friction */
#define WALL_NEAREST 0.25

struct isph;

/* Layers of boundary particles that a support needs. */
int isph_boundary_layers(const struct isph *s);
/* Adds a boundary particle of a wall box or open side; `volume`: its bulk volume. *capacity starts
 * at 0 and belongs to the arrays. */
enum status isph_boundary_add(struct isph *s, size_t *capacity, const double x[3],
                              enum boundary_kind kind, size_t box, double volume);
/* Releases the room that is left after the last. */
enum status isph_boundary_trim(struct isph *s);

#endif
