/* What the full resolution of the scan knows of the grain surface, carried down to the model's
 * voxels: signed distance of each voxel centre, grain volume fraction, surface area. */
#ifndef TOSUI_CT2MODEL_SURFACE_WALL_DISTANCE_H
#define TOSUI_CT2MODEL_SURFACE_WALL_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "ct2model/scan/region.h"

struct wall_request {
  double threshold; /* of the full resolution; grain is above */
  double contrast;  /* grain minus pore grey, for scaling only */
  size_t size[3];   /* of the model before mirroring; x, y, z */
  bool distances;   /* off: surface area only */
  bool mirror; /* reflected about z = 0 and about the centre of the last layer; else periodic */
};

struct wall_result {
  float *distance;       /* [z][y][x], m, positive in the pore; INFINITY beyond the band */
  float *grain_fraction; /* [z][y][x] */
  double surface_area;   /* m^2 in the region, from the changes of phase (crossing.h) */
  size_t specks;         /* voxels of islands too small for a model voxel, left out */
};

/* Reads the region once more, slab by slab. Free with wall_result_end. */
enum status wall_measure(const struct region *region, const struct wall_request *request,
                         struct wall_result *result);
void wall_result_end(struct wall_result *result);

/* Fills INFINITY by the eikonal equation from the known values, periodic in all directions (fast
 * sweeping, Zhao 2005); `size` and `spacing` x, y, z. The signs are those of `solid`: where the
 * resampled model and the full resolution disagree on the phase of a voxel's centre, and where the
 * centre is nearer than 1 % of the spacing, the distance becomes -+ 1 % of the spacing;
 * *disagree counts the former. */
enum status wall_complete(float *distance, const unsigned char *solid, const size_t size[3],
                          const double spacing[3], size_t *disagree);

#endif
