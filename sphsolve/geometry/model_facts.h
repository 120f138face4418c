/* Metadata of a model file, read once together with its voxels. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_MODEL_FACTS_H
#define TOSUI_SPHSOLVE_GEOMETRY_MODEL_FACTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Quality of the CT scan as estimated from the scan itself, SI units. */
struct scan_quality {
  bool known;              /* scan data are available */
  double blur, blur_error; /* measured standard deviation; its standard error */
  double resolution;       /* period at which the transfer function is 10 % */
  double noise_power;      /* m^3: variance / contrast^2 times correlation volume */
  double smooth_walls;     /* from 0 (rough walls) to 1 (no roughness) */
  double between; /* m^2: blur variance due to interpolation between distant slices, per axis */
  double shape;   /* relative error of k where pores are too narrow to resolve their shape */
  bool labels;    /* the scan was segmented: of these only `resolution`, `between` and
                     `void_ratio_error` are known */
  double void_ratio_error; /* 95 % half width of the void ratio: as counted from labels, if none was
                              measured; or where the scan shows another one than was measured */
  bool assumed;            /* none of these could be estimated: a blur of 1.2 voxels is assumed */
  bool removed;            /* the blur was removed from the model's surface */
};
/* Period, in standard deviations, at which the transfer function of a Gaussian is 10 %: 2 pi /
 * sqrt(2 ln 10). */
#define RESOLUTION_DEVIATIONS 2.9278

/* All 0 without a model. Quantities that the file does not contain are NAN. */
struct model_facts {
  uint64_t hash;                /* of the file */
  size_t count;                 /* number of voxels, whatever the sites of a lattice */
  double voxel;                 /* m: edge of a cube with the volume of a voxel */
  double voxel_scanned;         /* m: the same for the scan */
  double void_ratio_error;      /* void ratio of the model minus the measured one */
  double threshold_slope;       /* d threshold / d void ratio, grey values */
  double threshold_uncertainty; /* grey values */
  double soil_error;            /* standard error of ln k of its soil */
  /* Sides in x and y (`--sides` of ct2model): wrapped around although no real sample is periodic,
   * or mirrored, so that the model contains the sample twice along each axis. */
  bool sides_wrapped, sides_mirrored;
  bool sides_stated; /* wrapped, and the user says that the image is periodic */
  bool z_mirrored;   /* the default of `--mirror` of ct2model */
  /* Axes along which the model is wrapped around although its pores do not continue: x and y where
   * the sides are wrapped, z where the first and last layer do not belong to a periodic body
   * (side_distance.h). */
  bool unlike[3];
  bool flow_cut; /* pores do not continue across the boundary along the single axis of the flow */
  bool mirrored[3]; /* the lattice is mirrored along this axis, the model file is not */
  struct scan_quality scan;
};

/* Reads all members except `count`, `voxel`, `unlike`, `flow_cut` and `mirrored`. */
enum status model_facts_read(const char *path, struct model_facts *facts);

#endif
