/* What both ways to find wall distances use: the voxels around one, nearest first. */
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
/* All voxels within reach, nearest faces first; returns how many. */
int distance_offsets(const double spacing[3], struct offset offsets[OFFSETS]);
double distance_reach(const double spacing[3]);

#endif
