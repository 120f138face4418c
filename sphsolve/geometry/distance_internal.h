/* Voxels around a given one, nearest first: shared by both computations of wall distances. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_DISTANCE_INTERNAL_H
#define TOSUI_SPHSOLVE_GEOMETRY_DISTANCE_INTERNAL_H

#include "sphsolve/geometry/distance.h"

enum { WIDTH = 2 * DISTANCE_REACH + 1, OFFSETS = WIDTH * WIDTH * WIDTH };

struct grid {
  const size_t *size;
  const double *spacing;
  const bool *periodic;
};

struct offset {
  int by[3];
  double face; /* distance from a centre to the nearest point of that voxel */
};

/* Index of the site at x + offset, or -1 outside an axis that does not repeat. */
long distance_neighbour(const struct grid *grid, const long x[3], const int offset[3]);
/* Offsets to all voxels within reach, sorted by the distance to their nearest point; returns their
 * number. */
int distance_offsets(const double spacing[3], struct offset offsets[OFFSETS]);
/* Largest distance (m) that is computed. */
double distance_reach(const double spacing[3]);

#endif
