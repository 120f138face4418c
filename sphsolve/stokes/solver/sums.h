/* Sums over long vectors: over blocks of a fixed length, and over these in order, so that the
 * results do not depend on the number of threads. Only this rank's part is summed. */
#ifndef TOSUI_SPHSOLVE_STOKES_SOLVER_SUMS_H
#define TOSUI_SPHSOLVE_STOKES_SOLVER_SUMS_H

#include <stddef.h>

#define STOKES_SUM_BLOCK ((size_t)4096)

/* Number of blocks of n values: the length of `partial` below. */
size_t stokes_sum_blocks(size_t n);
/* End of a block (index of its last value plus 1) of n values. */
size_t stokes_sum_block_end(size_t block, size_t n);
/* Sum of the partial sums of all blocks. */
double stokes_sum_total(size_t n, const double *partial);
/* Sum of x y. */
double stokes_sum_dot(size_t n, const float *x, const float *y, double *partial);

#endif
