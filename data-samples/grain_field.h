/* The packing on the voxels of the scan: distance to the nearest grain, and which grain that is. */
#ifndef TOSUI_DATA_SAMPLES_GRAIN_FIELD_H
#define TOSUI_DATA_SAMPLES_GRAIN_FIELD_H

#include <stddef.h>
#include <stdint.h>

#include "data-samples/grain_packing.h"

/* Voxels kept around the scan, so that filters see sand, not an edge; wider filters want more. */
#define FIELD_HALO 8

struct grain_field {
  long size[3];    /* voxels of the scan; x, y, z */
  long halo;       /* voxels kept around it */
  long extent[3];  /* with the halo on both sides */
  double voxel;    /* m */
  float *distance; /* [extent z][y][x] in voxels, negative in the grain; large far away */
  uint32_t *label; /* the nearest grain, [extent z][y][x]; 0 far from all */
  double offset;   /* voxels: what `distance` is below in the grains of the exact void ratio */
  double shared;   /* share of the solid that two grains claimed; the nearer one has it */
  long solid;      /* voxels of the scan whose centre lies in a grain */
};

struct grain_statistics {
  long grains;         /* with a voxel in the scan */
  long whole_grains;   /* that lie wholly inside it */
  double diameter_min; /* m, of the whole grains: the sphere of the same voxel volume */
  double diameter_mean, diameter_max;
  double coordination;    /* neighbours touched, mean of the whole grains */
  double largest_cluster; /* share of the solid in the largest group of grains that touch */
};

/* Box of a packing from whose inside a scan of this size can be cut. */
void grain_field_box(const long size[3], double voxel, double largest, double box[3]);

/* What to draw of a packing. The same scan at `refine` times as many voxels a side has refine times
 * the size, a voxel smaller by it, and the same place in the packing. */
struct field_request {
  long size[3];
  double voxel; /* m */
  long halo;    /* voxels, FIELD_HALO or more */
  int refine;   /* 1: the scan itself */
  double void_ratio;
  uint64_t seed;
};

/* Draws the packing on the voxels and chooses `offset`, to 1/262144 of a voxel, so that the solid
 * voxels are as many as the void ratio asks for: to some ten voxels in a scan of 59 million.
 * STATUS_NUMERIC when the packing is too far from it for a small offset. Free with _destroy. */
enum status grain_field_create(struct grain_field *field, const struct grain_packing *packing,
                               const struct field_request *request);
void grain_field_destroy(struct grain_field *field);

/* Index of voxel (x, y, z) of the scan into `distance` and `label`. */
static inline size_t grain_field_index(const struct grain_field *field, long x, long y, long z) {
  return ((size_t)(z + field->halo) * (size_t)field->extent[1] + (size_t)(y + field->halo)) *
             (size_t)field->extent[0] +
         (size_t)(x + field->halo);
}

/* Counts grains, their sizes and contacts (two grains touch where two of their solid voxels share
 * a face). */
enum status grain_field_measure(const struct grain_field *field, long grains,
                                struct grain_statistics *statistics);

#endif
