/* The permeability tensor of a body from three runs, driven along x, y and z. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_TENSOR_H
#define TOSUI_SPHSOLVE_OUTPUT_TENSOR_H

#include <jansson.h>
#include <stdbool.h>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/error/uncertainty.h"
#include "sphsolve/scene/scene.h"

/* Result for one direction of the force. */
struct tensor_column {
  double velocity[3]; /* Darcy velocity under a unit hydraulic gradient, m/s */
  double low, high;   /* relative 95 % bounds of its k */
  double finest;      /* k of the finest lattice divided by k: 1 unless k is extrapolated */
  char path[4096];    /* its record; "" if there is none yet */
};

struct tensor {
  struct tensor_column columns[3];
  bool mirrored[3];  /* the body is mirror symmetric along the axis */
  bool by_run[3];    /* by mirroring in the run, not in the model */
  double to_area;    /* nu / g: intrinsic permeability (m^2) divided by k (m/s) */
  double voxel;      /* m, geometric mean of the axes */
  double k[3][3];    /* m/s, symmetric; row: flow, column: gradient */
  double low[3][3];  /* m/s: the 95 % interval of each term */
  double high[3][3]; /* m/s */
  /* Largest |k_ij - k_ji| divided by the mean of the diagonal; NAN: all are zero. */
  double asymmetry;
  double principal[3]; /* m/s, largest first */
  double axes[3][3];   /* their unit vectors, one per row */
  double principal_low[3], principal_high[3];
  bool isotropic; /* the principal values are equal within their errors */
};

/* Finds whether the body driven along `axis` is mirror symmetric along it (kinds of sites and wall
 * distances): such a force causes no mean flow across itself, so the off-diagonal terms are
 * zero. */
void tensor_find_mirror(const struct lattice *lattice, int axis, struct tensor *tensor);
/* Sets the column of a run driven along `axis`: its Darcy velocity (m/s), its error, and k of the
 * finest lattice / k (NAN: 1). With the third column the tensor is computed. */
void tensor_set_column(const struct scene *scene, const double darcy_velocity[3],
                       const struct uncertainty *error, double finest, int axis, const char *prefix,
                       struct tensor *tensor);
/* The same from the record in PREFIX.hdf; false unless that is a finished run of the same scene and
 * lattice with k known to the `wanted` error (0: on the lattice's own sites). */
bool tensor_read_column(const struct scene *scene, const struct lattice *lattice, double wanted,
                        const char *prefix, int axis, struct tensor *tensor);
/* Whether all three columns are set. */
bool tensor_complete(const struct tensor *tensor);

/* Print to stdout, or return a new JSON object. */
void tensor_print(const struct tensor *tensor);
json_t *tensor_json(const struct tensor *tensor);
/* Writes /run/tensor of an open file. */
enum status tensor_write(const struct tensor *tensor, struct h5_file *file);

#endif
