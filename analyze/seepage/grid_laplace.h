/* Laplace's equation on the graph of a grid in the plane. */
#ifndef TOSUI_ANALYZE_SEEPAGE_GRID_LAPLACE_H
#define TOSUI_ANALYZE_SEEPAGE_GRID_LAPLACE_H

#include <stddef.h>

#include "common/error.h"

/* sum over neighbours n of w (x[c] - x[n]) + held[c] x[c] = source[c] at each of [nz][nx] nodes, the
 * first index slowest. */
struct grid_laplace {
  size_t nx, nz;
  double *along, *upward; /* w to the next node of the row, of the column; none beyond the last */
  double *held;           /* w to a node outside whose value times w is in the source */
  double *source;
};

/* All weights and sources 0. Free with grid_laplace_free, also after a failure. */
enum status grid_laplace_create(size_t nx, size_t nz, struct grid_laplace *grid);
void grid_laplace_free(struct grid_laplace *grid);

/* Conjugate gradients from x[nz][nx] until the residual is `goal` of that of x = 0. Nodes without
 * neighbours keep their x; with nothing held x is known to a constant, as it began. */
enum status grid_laplace_solve(const struct grid_laplace *grid, double goal, double *x);

#endif
