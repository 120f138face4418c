/* The wall seen from a site: normal and curvature of the surface, from the wall distances around.
 * Where distances from two walls meet, or are noise, their gradient is no unit vector: there is no
 * normal then, and the wall is taken as flat. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_WALL_SHAPE_H
#define TOSUI_SPHSOLVE_GEOMETRY_WALL_SHAPE_H

#include "sphsolve/geometry/lattice.h"

struct wall_shape {
  double distance;  /* m */
  double normal[3]; /* x, y, z, out of the wall; 0 where there is none */
  double curvature; /* 1/m: Laplacian of the distance */
};
/* `spacing`: m, to whose inverse the curvature is held. In 2-D the y axis does not exist. */
void wall_shape_find(const struct lattice *lattice, size_t site, double spacing,
                     struct wall_shape *shape);

#endif
