/* Conduction and advection between the cells of a flow, as finite volumes (Patankar 1980, 5.2):
 *   sum over faces of  s F (b_P + b_N) / 2  -  G (b_N - b_P)   =   source
 * G: open area of a face over the distance between the two centres; F: volume flux through it; s:
 * inverse of the diffusion coefficient. The mean of both sides (central differences) introduces no
 * numerical diffusion, whatever s; with s = 0 the operator is the Laplacian. Lengths are in units
 * of the first spacing, velocities in units of the flow's mean speed, so that s is the Peclet
 * number of that length.
 *
 * Arrays have an additional layer of cells on each side: copies of those at the far end of the box
 * (periodic ghost cells). */
#ifndef TOSUI_SPHSOLVE_SOLUTE_CELLS_H
#define TOSUI_SPHSOLVE_SOLUTE_CELLS_H

#include <stdbool.h>

#include "common/error.h"
#include "sphsolve/solute/volumes.h"

struct solute_cells {
  int n[3];
  size_t stride[3];                /* of the arrays, which begin with the layer of ghost cells */
  size_t size;                     /* of one array, ghost cells included */
  double *width[3];                /* [n] width of the cells along each axis */
  float *conductance[3], *flux[3]; /* of the face at the low side; flux NULL: no flow */
  float *volume;
};

/* The cells of a flow, its axes in the order `axis`: the solver's axis a is axis[a]. Free with
 * solute_cells_free. */
enum status solute_cells_of_flow(const struct solute_flow *flow, const int axis[3],
                                 struct solute_cells *cells);
/* Coarser cells, of two by two by two each; the last of an odd number stays single. Volumes, areas
 * and fluxes are sums, so that the fluxes stay conservative. Free with solute_cells_free. */
enum status solute_cells_coarsen(const struct solute_cells *fine, struct solute_cells *coarse);
void solute_cells_free(struct solute_cells *cells);

/* Distance of the two centres across the face at the low side of cell i along an axis. */
static inline double solute_cells_apart(const struct solute_cells *c, int axis, int i) {
  return 0.5 * (c->width[axis][i] + c->width[axis][i > 0 ? i - 1 : c->n[axis] - 1]);
}

static inline size_t solute_cells_at(const struct solute_cells *c, int i, int j, int k) {
  return (size_t)(k + 1) * c->stride[2] + (size_t)(j + 1) * c->stride[1] + (size_t)(i + 1);
}

/* Fills the ghost cells of an array. */
void solute_cells_wrap(const struct solute_cells *cells, float *x);
void solute_cells_wrap_exact(const struct solute_cells *cells, double *x);

/* y = A x; the ghost cells of x must be up to date. */
void solute_cells_apply(const struct solute_cells *cells, double s, const float *x, float *y);
/* y = source - A x, in double precision. */
void solute_cells_residual(const struct solute_cells *cells, double s, const double *source,
                           const double *x, float *y);
/* Mean of x over all cells, weighted by volume. */
double solute_cells_mean(const struct solute_cells *cells, const double *x);

#endif
