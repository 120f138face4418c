/* Sums over long vectors: over blocks of a fixed length, and over these in their order, so that the
 * bits do not depend on the threads. Of this rank's part alone. */
#ifndef TOSUI_SPHSOLVE_STOKES_SOLVER_SUMS_H
#define TOSUI_SPHSOLVE_STOKES_SOLVER_SUMS_H

#include <stddef.h>

#define STOKES_SUM_BLOCK ((size_t)4096)

/* Blocks of n values, for which `partial` below has room. */
size_t stokes_sum_blocks(size_t n);
/* The end of a block of n values. */
size_t stokes_sum_block_end(size_t block, size_t n);
/* Over the blocks. */
double stokes_sum_total(size_t n, const double *partial);
/* Sum of x y. */
double stokes_sum_dot(size_t n, const float *x, const float *y, double *partial);

#endif
