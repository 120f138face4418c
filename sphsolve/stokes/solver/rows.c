#include "sphsolve/stokes/solver/rows.h"

#define STOKES_ROWS_TABLE stokes_rows_base
#define STOKES_ROWS_NAME "sse2"
#include "sphsolve/stokes/solver/rows_body.h"

size_t stokes_rows_scratch(size_t stride) {
  return (STOKES_REACH + 1) * (stride + 2 * STOKES_LANES);
}

uint8_t stokes_rows_expand[256][8], stokes_rows_compress[256][8], stokes_rows_first[9][8];

static void fill_tables(void) {
  for (unsigned bits = 0; bits < 256; bits++)
    for (unsigned site = 0, at = 0; site < 8; site++) {
      const bool pore = bits >> site & 1;
      stokes_rows_expand[bits][site] = (uint8_t)(pore ? at : STOKES_ROWS_EMPTY);
      if (pore) stokes_rows_compress[bits][at++] = (uint8_t)site;
    }
  for (unsigned count = 0; count < 9; count++)
    memset(stokes_rows_first[count], STOKES_ROWS_EMPTY, count);
}

const struct stokes_rows *stokes_rows_best(void) {
  if (stokes_rows_first[1][0] == 0) fill_tables();
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"))
    return &stokes_rows_avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return &stokes_rows_avx2;
  return &stokes_rows_base;
}
