/* Wall distances at the sides of a sample that was wrapped, and is to be so no more. */
#ifndef TOSUI_COMMON_SIDE_DISTANCE_H
#define TOSUI_COMMON_SIDE_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>

/* Distances that were found with the opposite side for a neighbour: those that reach beyond a side
 * of those axes, x or y, become unknown, INFINITY, or where the other phase is next to a voxel, what
 * is left of the way between the two. distance[z][y][x] of n. */
void sides_forget(const size_t n[3], const double spacing[3], const bool axes[2], float *distance);

#endif
