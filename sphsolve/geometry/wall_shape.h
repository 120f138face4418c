/* Normal and curvature of the wall near a site, from the surrounding wall distances. Where the
 * distances from two walls meet or are noisy, the gradient is not a unit vector: there is no
 * normal, and the wall is taken as flat. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_WALL_SHAPE_H
#define TOSUI_SPHSOLVE_GEOMETRY_WALL_SHAPE_H

#include "sphsolve/geometry/lattice.h"

struct wall_shape {
  double distance;  /* m */
  double normal[3]; /* x, y, z, pointing out of the wall; 0 if there is none */
  double curvature; /* 1/m: Laplacian of the distance */
};
/* The curvature is limited in proportion to 1/`spacing` (m). In 2-D there is no y axis. */
void wall_shape_find(const struct lattice *lattice, size_t site, double spacing,
                     struct wall_shape *shape);

/* Largest curvature, 1/m, of the wall nearest to a fluid site where it is convex seen from the
 * fluid; infinite at an edge, 0 at a plane or hollow wall. The largest curvature K of the surface
 * at distance d from the wall that passes through the site is the largest second difference of
 * the wall distance along the lines to neighbours; that of the wall is K / (1 - K d), as parallel
 * surfaces have a common centre of curvature (do Carmo 1976, Differential Geometry of Curves and
 * Surfaces, sec. 3-5). 0 in a lattice without wall distances. */
double wall_curvature(const struct lattice *lattice, const size_t at[3]);

#endif
