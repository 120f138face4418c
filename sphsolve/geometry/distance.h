/* Signed distance from the centres of sites to the wall, m, positive in the fluid, where the model
 * brings none of its own. Distances are exact within DISTANCE_REACH spacings and bounded there. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_DISTANCE_H
#define TOSUI_SPHSOLVE_GEOMETRY_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/scene/scene.h"

#define DISTANCE_REACH 4

/* To the faces between pore and grain voxels: the sharp voxel geometry. Arrays [z][y][x]; sizes and
 * spacings x, y, z. Of planes [first, end) across z. */
void distance_from_faces(const size_t size[3], const double spacing[3], const bool periodic[3],
                         size_t first, size_t end, const uint8_t *solid, float *distance);

/* To the surface that leaves each cut voxel its share of grain; in blurred fields to that where the
 * fraction is 1/2. */
enum status distance_from_fraction(const size_t size[3], const double spacing[3],
                                   const bool periodic[3], size_t first, size_t end,
                                   const float *grain_fraction, float *distance);

/* To the walls of a domain scene at the point x: closed sides and wall boxes, later regions
 * overwriting earlier ones. */
double distance_to_boxes(const struct scene *scene, const double x[3]);

#endif
