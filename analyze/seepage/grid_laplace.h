/* Laplace's equation on the graph of a two-dimensional grid. */
#ifndef TOSUI_ANALYZE_SEEPAGE_GRID_LAPLACE_H
#define TOSUI_ANALYZE_SEEPAGE_GRID_LAPLACE_H

#include <stddef.h>

#include "common/error.h"

/* Sum over neighbours n of w (x[c] - x[n]) + held[c] x[c] = source[c] at each of the [nz][nx]
 * nodes; the last index varies fastest. */
struct grid_laplace {
  size_t nx, nz;
  double *along, *upward; /* w to the next node in the row, in the column; 0 at the last */
  /* w to nodes with prescribed values; `source` contains w times the value. */
  double *held;
  double *source;
};

/* Allocates with all weights and sources 0. Free with grid_laplace_free, also after a failure. */
enum status grid_laplace_create(size_t nx, size_t nz, struct grid_laplace *grid);
void grid_laplace_free(struct grid_laplace *grid);

/* Conjugate gradients from the initial x [nz][nx] until the residual is `goal` times that of x = 0.
 * Nodes without neighbours keep their x. If no value is prescribed the constant part of x is that
 * of the initial x. */
enum status grid_laplace_solve(const struct grid_laplace *grid, double goal, double *x);

#endif
