/* model.hdf: the voxel model between ct2model and sphsolve. See docs/formats.md. */
#ifndef TOSUI_COMMON_MODEL_FILE_H
#define TOSUI_COMMON_MODEL_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/constants.h"
#include "common/error.h"
#include "common/hdf5_file.h"

/* Sizes and vectors have the order x, y, z in memory; arrays are [z][y][x], x fastest. The file
 * stores vector attributes in the order z, y, x. */
struct voxel_model {
  size_t size[3];
  double spacing[3]; /* m */
  bool periodic[3];
  int mirror_plane;                      /* layer index along the mirror axis, -1: none */
  double void_ratio;                     /* of this model, by counting voxels */
  double void_ratio_measured, threshold; /* NAN where unknown */
  uint8_t *solid;                        /* 1 grain, 0 pore */
  float *wall_distance;                  /* m, positive in the pore; NULL if absent */
  float *grain_fraction;                 /* 0..1; NULL if absent */
  /* Soil with pores smaller than the voxels, in voxels that are not solid: porosity (0..1) and
   * permeability (m^2), 0 elsewhere. Both are present or both NULL. */
  float *micro_porosity, *micro_permeability;
};

/* Number of voxels, the product of the sizes. */
size_t model_site_count(const struct voxel_model *model);
/* Pore volume, including the pores of the soil, over the volume of the model. */
double model_porosity(const struct voxel_model *model);
/* Soil of a model: share of its voxels that are soil, their mean porosity and the geometric mean of
 * their permeability (m^2). */
struct micro_summary {
  double voxels, porosity, permeability;
};
struct micro_summary micro_summary(const struct voxel_model *model);
/* Frees the arrays. */
void model_free(struct voxel_model *model);
/* Largest ratio of the edges of a voxel that is accepted: the lattice consists of cubes. */
#define MODEL_LONGEST_EDGE 1.5

/* Reads a model and validates its sizes and values. Only /model/solid and its attribute `spacing`
 * are required; the default is periodic. */
enum status model_read(const char *path, struct voxel_model *model);
/* Void ratio of the model minus the measured one; NAN if either is unknown. */
double model_void_ratio_error(struct h5_file *file);
/* Writes /model and its /VTKHDF view (ImageData 1.0, PointData by soft links) into an open file.
 * ct2model then adds calibration and provenance, and commits. */
enum status model_write(struct h5_file *file, const struct voxel_model *model);

#endif
