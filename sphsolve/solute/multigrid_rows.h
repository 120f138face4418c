/* The rows of the multigrid cycle (multigrid.h), where its time goes: each as long as the cells
 * along the first axis, made of vectors by the compiler. `at`: place of the first cell; `half`:
 * half of s; `flows`: whether there is a flow at all. Closed cells have inverse 0 and stay 0. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_MULTIGRID_ROWS_H
#define TOSUI_SPHSOLVE_SOLUTE_MULTIGRID_ROWS_H

#include "sphsolve/solute/cells.h"

/* One over the diagonal of the cycle's operator. */
void multigrid_row_inverse(const struct solute_cells *cells, float half, bool flows, size_t at,
                           float *inverse);
/* Every other cell, from the `first` on, to where its equation holds. */
void multigrid_row_relax(const struct solute_cells *cells, float half, bool flows, size_t at,
                         int first, const float *inverse, const float *rest, float *x);
/* out = rest - A' x. */
void multigrid_row_defect(const struct solute_cells *cells, float half, bool flows, size_t at,
                          const float *inverse, const float *rest, const float *x, float *out);
/* Adds the correction of the coarser cells between which the row lies: `near` the first cell of the
 * row it lies in, `steps` from there to the next nearest row along the second and third axes. With
 * 3/4 and 1/4 along each axis, over the sum of those of open cells: share = 1 / that sum. */
void multigrid_row_prolong(const float *y, size_t near, const ptrdiff_t steps[2], int count,
                           const float *share, float *x);
/* That share, from the inverse diagonals of fine and coarse cells. */
void multigrid_row_share(const float *coarse_inverse, size_t near, const ptrdiff_t steps[2],
                         int count, const float *inverse, float *share);

#endif
