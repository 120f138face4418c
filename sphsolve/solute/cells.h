/* Conduction and advection between the cells of a flow, as finite volumes (Patankar 1980, 5.2):
 *   sum over faces of  s F (b_P + b_N) / 2  -  G (b_N - b_P)   =   source
 * G: open area of a face over the distance between the two centres; F: volume flux through it; s:
 * one over the diffusion coefficient. The mean of both sides (central differences) brings no
 * diffusion of its own, whatever s; with s = 0 the operator is that of Laplace. Lengths are in
 * units of the first spacing, velocities in units of the flow's mean speed, so that s is the Peclet
 * number of that length.
 *
 * Arrays have a layer of cells more on each side, copies of those at the far end of the box. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_CELLS_H
#define TOSUI_SPHSOLVE_SOLUTE_CELLS_H

#include <stdbool.h>

#include "common/error.h"
#include "sphsolve/solute/volumes.h"

struct solute_cells {
  int n[3];
  size_t stride[3];                /* of the arrays, which begin with the layer of copies */
  size_t size;                     /* of one array */
  double *width[3];                /* [n], of the cells along each axis */
  float *conductance[3], *flux[3]; /* of the face at the low side; flux NULL: at rest */
  float *volume;
};

/* Of a flow, its axes in the order `axis`: cells of the solver's axis a are those of axis[a]. */
enum status solute_cells_of_flow(const struct solute_flow *flow, const int axis[3],
                                 struct solute_cells *cells);
/* Two by two by two of them; the last of an odd number stays alone. Volumes, areas and fluxes are
 * sums, so that nothing is lost. */
enum status solute_cells_coarsen(const struct solute_cells *fine, struct solute_cells *coarse);
void solute_cells_free(struct solute_cells *cells);

/* Centre to centre across the face at the low side of cell i along an axis. */
static inline double solute_cells_apart(const struct solute_cells *c, int axis, int i) {
  return 0.5 * (c->width[axis][i] + c->width[axis][i > 0 ? i - 1 : c->n[axis] - 1]);
}

static inline size_t solute_cells_at(const struct solute_cells *c, int i, int j, int k) {
  return (size_t)(k + 1) * c->stride[2] + (size_t)(j + 1) * c->stride[1] + (size_t)(i + 1);
}

/* Fills the layers of copies. */
void solute_cells_wrap(const struct solute_cells *cells, float *x);
void solute_cells_wrap_exact(const struct solute_cells *cells, double *x);

/* y = A x; the copies of x are fresh. */
void solute_cells_apply(const struct solute_cells *cells, double s, const float *x, float *y);
/* y = source - A x, in double precision. */
void solute_cells_residual(const struct solute_cells *cells, double s, const double *source,
                           const double *x, float *y);
/* The sum over all cells of x times volume, over that of volume. */
double solute_cells_mean(const struct solute_cells *cells, const double *x);

#endif
