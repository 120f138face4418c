#include "sphsolve/stokes/solver/sums.h"

size_t stokes_sum_blocks(size_t n) {
  return (n + STOKES_SUM_BLOCK - 1) / STOKES_SUM_BLOCK;
}

size_t stokes_sum_block_end(size_t block, size_t n) {
  const size_t end = (block + 1) * STOKES_SUM_BLOCK;
  return end < n ? end : n;
}

double stokes_sum_total(size_t n, const double *partial) {
  double total = 0.0;
  for (size_t b = 0; b < stokes_sum_blocks(n); b++) total += partial[b];
  return total;
}

typedef float lanes __attribute__((vector_size(64), aligned(4), may_alias));

/* Sum of x y over a block: short runs in float, these added in double precision. */
static double dot_block(size_t n, const float *x, const float *y) {
  double sum = 0.0;
  size_t i = 0;
  while (i + 16 <= n) {
    lanes run = {0};
    for (const size_t end = i + 256; i + 16 <= n && i < end; i += 16)
      run += *(const lanes *)(x + i) * *(const lanes *)(y + i);
    for (int l = 0; l < 16; l++) sum += (double)run[l];
  }
  for (; i < n; i++) sum += (double)x[i] * (double)y[i];
  return sum;
}

double stokes_sum_dot(size_t n, const float *x, const float *y, double *partial) {
#pragma omp parallel for schedule(static)
  for (size_t b = 0; b < stokes_sum_blocks(n); b++) {
    const size_t start = b * STOKES_SUM_BLOCK;
    partial[b] = dot_block(stokes_sum_block_end(b, n) - start, x + start, y + start);
  }
  return stokes_sum_total(n, partial);
}
