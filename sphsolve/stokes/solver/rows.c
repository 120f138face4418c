#include "sphsolve/stokes/solver/rows.h"

#define STOKES_ROWS_TABLE stokes_rows_base
#define STOKES_ROWS_NAME "sse2"
#include "sphsolve/stokes/solver/rows_body.h"

size_t stokes_rows_scratch(size_t stride) {
  return (STOKES_REACH + 1) * (stride + 2 * STOKES_LANES);
}

const struct stokes_rows *stokes_rows_best(void) {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    return &stokes_rows_avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return &stokes_rows_avx2;
  return &stokes_rows_base;
}
