/* How sharply the wall that is nearest to a site is curved. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_WALL_CURVATURE_H
#define TOSUI_SPHSOLVE_GEOMETRY_WALL_CURVATURE_H

#include "sphsolve/geometry/lattice.h"

/* Largest curvature, 1/m, of the wall nearest to a fluid site where it is convex seen from the
 * fluid; infinite at an edge, 0 at a plane or hollow wall. The largest curvature K of the surface
 * at distance d from the wall that passes through the site is the largest second difference of
 * the wall distance along the lines to neighbours; that of the wall is K / (1 - K d), as parallel
 * surfaces have a common centre of curvature (do Carmo 1976, Differential Geometry of Curves and
 * Surfaces, sec. 3-5). 0 in a lattice without wall distances. */
double wall_curvature(const struct lattice *lattice, const size_t at[3]);

#endif
