/* Measures the grain surface at the full resolution of the scan for the voxels of the model: signed
 * distance of each voxel centre, grain volume fraction, surface area. */
#ifndef TOSUI_CT2MODEL_SURFACE_WALL_DISTANCE_H
#define TOSUI_CT2MODEL_SURFACE_WALL_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "ct2model/scan/region.h"

struct wall_request {
  double threshold; /* grey of the full resolution; grain is above */
  double contrast;  /* grain minus pore grey, for scaling only */
  size_t size[3];   /* of the model before mirroring, along x, y, z */
  bool distances;   /* false: surface area only */
  bool mirror;      /* reflected at z = 0 and at the centre of the last layer; else periodic */
};

struct wall_result {
  float *distance;       /* [z][y][x], m, positive in the pore; INFINITY beyond the band */
  float *grain_fraction; /* [z][y][x] */
  double surface_area;   /* m^2 in the region, by counting changes of phase (crossing.h) */
  size_t specks;         /* voxels of islands too small for a model voxel, which were removed */
};

/* Measures the walls; reads the region once, slab by slab. Free with wall_result_end. */
enum status wall_measure(const struct region *region, const struct wall_request *request,
                         struct wall_result *result);
void wall_result_end(struct wall_result *result);

/* Replaces infinite distances by the solution of the eikonal equation from the finite ones,
 * periodic in all directions (fast sweeping, Zhao 2005); `size` and `spacing` (m) along x, y, z.
 * The signs become those of `solid`. Where the resampled model and the full resolution disagree on
 * the phase of a voxel's centre, or where the centre is nearer to the surface than 1 % of the
 * spacing, the distance becomes -+ 1 % of the spacing; *disagree counts the former. */
enum status wall_complete(float *distance, const unsigned char *solid, const size_t size[3],
                          const double spacing[3], size_t *disagree);

#endif
