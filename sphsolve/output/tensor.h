/* The permeability tensor of a body from three runs, driven along x, y and z. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_TENSOR_H
#define TOSUI_SPHSOLVE_OUTPUT_TENSOR_H

#include <jansson.h>
#include <stdbool.h>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/output/uncertainty.h"
#include "sphsolve/scene/scene.h"

/* What one direction gave. */
struct tensor_column {
  double velocity[3]; /* Darcy velocity under a unit hydraulic gradient, m/s */
  double low, high;   /* relative bounds of its k, 95 % */
  double finest;      /* k of the finest lattice over k: 1 but for an estimate from several */
  char path[4096];    /* its record; "" while there is none */
};

struct tensor {
  struct tensor_column columns[3];
  bool mirrored[3];    /* the body is its own mirror image along the axis, where flow takes it */
  bool by_run[3];      /* as its run mirrored it, not its model */
  double to_area;      /* nu / g: intrinsic permeability, m^2, over k, m/s */
  double voxel;        /* m, geometric mean of the axes */
  double k[3][3];      /* m/s, symmetric; row: flow, column: gradient */
  double low[3][3];    /* m/s: the 95 % interval of each term */
  double high[3][3];   /* m/s */
  double asymmetry;    /* largest |k_ij - k_ji| over the mean of the diagonal; NAN: all are zero */
  double principal[3]; /* m/s, largest first */
  double axes[3][3];   /* their unit vectors, one a row */
  double principal_low[3], principal_high[3];
  bool isotropic; /* the principal values do not differ by more than their errors */
};

/* Whether the body that is driven along `axis` is its own mirror image along it (sites and their
 * distances to the wall): such a force makes no mean flow across itself, so the terms off the
 * diagonal are zero. */
void tensor_find_mirror(const struct lattice *lattice, int axis, struct tensor *tensor);
/* The column of a run driven along `axis`: its Darcy velocity (m/s), its error, and k of the finest
 * lattice over its k (NAN: it is k). With the third the rest is found. */
void tensor_set_column(const struct scene *scene, const double darcy_velocity[3],
                       const struct uncertainty *error, double finest, int axis, const char *prefix,
                       struct tensor *tensor);
/* The same from a record that PREFIX.hdf holds already, if it is a finished one of just this scene
 * and lattice, and its k is known to the `wanted` error (0: of the lattice's own sites). */
bool tensor_read_column(const struct scene *scene, const struct lattice *lattice, double wanted,
                        const char *prefix, int axis, struct tensor *tensor);
bool tensor_complete(const struct tensor *tensor);

/* To stdout; as a new JSON object. */
void tensor_print(const struct tensor *tensor);
json_t *tensor_json(const struct tensor *tensor);
/* /run/tensor of an open file. */
enum status tensor_write(const struct tensor *tensor, struct h5_file *file);

#endif
