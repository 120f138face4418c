/* Signed distance (m) from the centres of sites to the wall, positive in the fluid, for models that
 * contain no distances themselves. Distances are exact up to DISTANCE_REACH spacings and limited to
 * that. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_DISTANCE_H
#define TOSUI_SPHSOLVE_GEOMETRY_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/scene/scene.h"

/* In spacings. */
#define DISTANCE_REACH 4

/* Distance to the faces between pore and grain voxels, i.e. to the sharp voxel geometry, for the
 * planes [first, end) along z. Arrays are [z][y][x]; sizes and spacings are in the order x, y,
 * z. */
void distance_from_faces(const size_t size[3], const double spacing[3], const bool periodic[3],
                         size_t first, size_t end, const uint8_t *solid, float *distance);

/* Distance to the surface that gives each cut voxel its grain fraction; in a blurred field, to the
 * surface where the fraction is 1/2. */
enum status distance_from_fraction(const size_t size[3], const double spacing[3],
                                   const bool periodic[3], size_t first, size_t end,
                                   const float *grain_fraction, float *distance);

/* Signed distance (m) from the point x to the walls of a domain scene: closed sides and wall boxes,
 * where later regions overwrite earlier ones. */
double distance_to_boxes(const struct scene *scene, const double x[3]);

#endif
