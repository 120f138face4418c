/* model.hdf: the voxel model between ct2model and sphsolve. See docs/formats.md. */
#ifndef TOSUI_COMMON_MODEL_FILE_H
#define TOSUI_COMMON_MODEL_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/hdf5_file.h"

/* Standard deviation, voxels, of the blur to assume where a scan tells none: edges of three voxels
 * from a tenth to nine tenths, as scanners are commonly set. */
#define MODEL_BLUR_ASSUMED 1.2

/* Sizes and vectors are in the order x, y, z in memory; arrays are [z][y][x], x fastest. The file
 * stores attribute vectors as z, y, x. */
struct voxel_model {
  size_t size[3];
  double spacing[3]; /* m */
  bool periodic[3];
  int mirror_plane;                      /* layer index along the mirror axis, -1: none */
  double void_ratio;                     /* of the model, counted */
  double void_ratio_measured, threshold; /* NAN where unknown */
  uint8_t *solid;                        /* 1 grain, 0 pore */
  float *wall_distance;                  /* m, positive in the pore; NULL if absent */
  float *grain_fraction;                 /* 0..1; NULL if absent */
  /* Soil whose pores are smaller than the voxels, in sites that are not solid: porosity 0..1 and
   * permeability (m^2), 0 where there is none; both or NULL. */
  float *micro_porosity, *micro_permeability;
};

/* Product of the sizes. */
size_t model_site_count(const struct voxel_model *model);
/* Volume of the pores over that of the model, those of the soil with them. */
double model_porosity(const struct voxel_model *model);
/* Of a model with soil: the share of its voxels that are soil, their mean porosity and the
 * geometric mean of their permeability (m^2). */
struct micro_summary {
  double voxels, porosity, permeability;
};
struct micro_summary micro_summary(const struct voxel_model *model);
/* Frees the arrays. */
void model_free(struct voxel_model *model);
/* Longest over shortest edge of voxels that are still solved: the lattice is one of cubes. */
#define MODEL_LONGEST_EDGE 1.5

/* Reads and validates: values, finiteness, sizes. Only /model/solid and its attribute `spacing` are
 * required (periodic by default). */
enum status model_read(const char *path, struct voxel_model *model);
/* The void ratio of the model less that measured on the specimen; NAN where either is unknown. */
double model_void_ratio_error(struct h5_file *file);
/* Writes /model and the /VTKHDF view (ImageData 1.0, PointData by soft links) into an open file;
 * ct2model adds calibration and provenance, then commits. */
enum status model_write(struct h5_file *file, const struct voxel_model *model);

#endif
