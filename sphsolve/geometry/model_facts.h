/* What a model's file says beside its voxels. Read once, with them. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_MODEL_FACTS_H
#define TOSUI_SPHSOLVE_GEOMETRY_MODEL_FACTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* What the scan tells of its scanner, SI. */
struct scan_quality {
  bool known;              /* there is a scan */
  double blur, blur_error; /* standard deviation as measured; 1 sigma of it */
  double resolution;       /* period seen at a tenth of its contrast */
  double noise_power;      /* m^3: variance over contrast^2, times the volume that it is alike in */
  double smooth_walls;     /* 0: they have relief, to 1: none */
  double between; /* m^2: variance by what is drawn between slices far apart, of one axis */
  double shape;   /* relative error of k where pores are too narrow to show their shape */
  bool labels;    /* segmented before: `resolution`, `between` and `counted` alone are known */
  double counted; /* 95 % half width of the void ratio by labels, where none was measured */
  bool assumed;   /* the scan told none of them: a blur of 1.2 voxels */
  bool removed;   /* the model's surface is that of the scan without its blur */
  bool averaged;  /* which was taken out of means of several voxels */
};
/* A Gaussian's transfer is a tenth at this period, in standard deviations: 2 pi / sqrt(2 ln 10). */
#define RESOLUTION_DEVIATIONS 2.9278

/* All 0 without a model. What a file does not know is NAN. */
struct model_facts {
  uint64_t hash;                                 /* of the file */
  size_t count;                                  /* its voxels, whatever sites a lattice has */
  double voxel;                                  /* m: edge of a cube as large as one */
  double voxel_scanned;                          /* m: the same of the scan */
  double void_ratio_error;                       /* of the model less that measured */
  double threshold_slope, threshold_uncertainty; /* d threshold / d void ratio; greys */
  double soil_error;                             /* of ln k of its soil */
  /* Its sides in x and y (`--sides` of ct2model): wrapped, though no real sample's are; or
   * mirrored, so that it holds its sample twice along each axis. */
  bool sides_wrapped, sides_mirrored;
  bool z_mirrored; /* as `--mirror` of ct2model does unless it is told otherwise */
  /* Axes along which it wraps round and its pores do not meet: x and y where sides are wrapped, z
   * where its first and last layers are of no periodic body (cut_pores.h). */
  bool unlike[3];
  bool flow_cut;    /* pores do not meet where it repeats itself along the one axis of its flow */
  bool mirrored[3]; /* the lattice is mirrored along this axis, and the file's model is not */
  struct scan_quality scan;
};

/* All but `count`, `voxel`, `unlike`, `flow_cut` and `mirrored`. */
enum status model_facts_read(const char *path, struct model_facts *facts);

#endif
