/* Row operations of the multigrid cycle (multigrid.h), its most expensive part: each row comprises
 * the cells along the first axis and is vectorised by the compiler. `at`: index of the first cell;
 * `half`: half of s; `flows`: whether there is a flow. Closed cells have inverse 0 and stay 0. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_MULTIGRID_ROWS_H
#define TOSUI_SPHSOLVE_SOLUTE_MULTIGRID_ROWS_H

#include "sphsolve/solute/cells.h"

/* Inverse of the diagonal of the cycle's operator. */
void multigrid_row_inverse(const struct solute_cells *cells, float half, bool flows, size_t at,
                           float *inverse);
/* Gauss-Seidel relaxation of every other cell, beginning with the `first`. */
void multigrid_row_relax(const struct solute_cells *cells, float half, bool flows, size_t at,
                         int first, const float *inverse, const float *rest, float *x);
/* out = rest - A' x. */
void multigrid_row_defect(const struct solute_cells *cells, float half, bool flows, size_t at,
                          const float *inverse, const float *rest, const float *x, float *out);
/* Adds the interpolated correction of the coarser cells around the row. `near`: index of the first
 * cell of the nearest coarse row; `steps`: offsets from there to the next nearest row along the
 * second and third axes. The weights are 3/4 and 1/4 along each axis, normalised over the open
 * cells: share = 1 / the sum of their weights. */
void multigrid_row_prolong(const float *y, size_t near, const ptrdiff_t steps[2], int count,
                           const float *share, float *x);
/* Computes that share from the inverse diagonals of fine and coarse cells. */
void multigrid_row_share(const float *coarse_inverse, size_t near, const ptrdiff_t steps[2],
                         int count, const float *inverse, float *share);

#endif
