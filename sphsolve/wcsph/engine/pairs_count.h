/* Number of pairs within the support. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_COUNT_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_COUNT_H

#include "sphsolve/wcsph/engine/pairs_gather.h"

SIMD_INLINE uint64_t count_columns(const struct pass *pass, struct local *local,
                                   const struct reference *ref, size_t n) {
  uint64_t pairs = 0;
  n = pad_columns(local, n, 0);
  for (int l = 0; l < CLUSTER; l++) {
    if (!ref->live[l]) continue;
    vec at[3], radius = vec_set(2 * pass->radius);
    row_position(pass, ref, l, at);
    for (size_t k = 0; k < n; k += SIMD_WIDTH)
      pairs += (uint64_t)__builtin_popcount(vec_below(pair_geometry(local, k, at).s, radius));
  }
  return pairs;
}
static void count(const struct pass *pass, struct local *local, size_t begin, size_t end,
                  uint64_t *pairs, uint64_t *alone) {
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    uint64_t self = 0, fluid;
    reference_make(pass, c, false, &ref);
    for (int l = 0; l < CLUSTER; l++) self += ref.live[l];
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref, 0, NULL, 0);
    fluid = count_columns(pass, local, &ref, n) - self;
    n = 0;
    if (pass->fluid_wall->rows > 0)
      n = gather_columns(pass, local, 0, pass->fluid_wall, c, true, &ref, 0, NULL, 0);
    *alone += fluid;
    *pairs += fluid + count_columns(pass, local, &ref, n);
  }
}
static void count_wall(const struct pass *pass, struct local *local, size_t begin, size_t end,
                       uint64_t *pairs) {
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, true, &ref);
    size_t n = gather_columns(pass, local, 0, pass->wall_fluid, c, false, &ref, 0, NULL, 0);
    *pairs += count_columns(pass, local, &ref, n);
  }
}

#endif
