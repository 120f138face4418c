/* Density by summation, and its contribution to frozen walls. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_DENSITY_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_DENSITY_H

#include "sphsolve/wcsph/effects/density_summation.h"
#include "sphsolve/wcsph/engine/pairs_gather.h"

/* Density of a row over columns [0, n); the contributions of the row to the columns from `walls` on
 * are added to LWEIGHT. */
SIMD_INLINE double row_density(const struct local *local, size_t walls, size_t n, const vec at[3]) {
  float tile[SIMD_LANES], *weight = local->field[LWEIGHT];
  for (int group = 0; group < SIMD_GROUPS; group++) {
    vec sum = vec_set(0.0f);
    size_t k = (size_t)group * SIMD_WIDTH;
    for (; k < walls; k += SIMD_LANES)
      density_summation_pair(kernel_vector_w(pair_geometry(local, k, at).s), &sum);
    for (; k < n; k += SIMD_LANES) {
      vec own = vec_set(0.0f);
      density_summation_pair(kernel_vector_w(pair_geometry(local, k, at).s), &own);
      sum += own;
      vec_store(weight + k, vec_load(weight + k) + own);
    }
    vec_store(tile + group * SIMD_WIDTH, sum);
  }
  return (double)lanes_sum(tile);
}

/* Adds the contributions to a cluster to those collected by this thread. */
SIMD_INLINE void collected_add(struct collected *to, uint32_t cluster, const uint32_t *shares,
                               uint32_t *sums) {
  const size_t at = cluster % COLLECTED;
  if (__builtin_expect(to->cluster[at] != cluster, 0)) {
    collected_give(to, at, sums);
    to->cluster[at] = cluster;
  }
  uint64_t more[CLUSTER / 2];
  memcpy(more, shares, sizeof more);
  for (int i = 0; i < CLUSTER / 2; i++) to->sum[at][i] += more[i];
}

/* Adds the contributions to the walls of a row cluster, from column `n` on, to the common sums.
 * They are integers, so the result does not depend on the order of rows and threads. */
SIMD_INLINE void spread_density(const struct pass *pass, const struct local *local, size_t n) {
  struct collected *collected = local->collected;
  uint32_t *sums = pass->particles->wall_sum, share[SIMD_LANES];
  const vec unit = vec_set((float)(pass->w_scale / WALL_SUM_UNIT));
  const uint32_t *slots = (const uint32_t *)(const void *)local->field[LSLOT];
  const uint32_t *masks = (const uint32_t *)(const void *)local->field[LMASK];
  for (size_t e = 0; e < local->entries; e++) {
    const uint32_t slot = slots[e], mask = masks[e];
    const vec weight = vec_expand(local->field[LWEIGHT] + n, mask);
    n += (size_t)__builtin_popcount(mask);
    const uvec whole = (uvec) __builtin_convertvector(weight * unit + 0.5f, ivec);
    if (collected == NULL) {
      uvec_store(sums + slot, uvec_load(sums + slot) + whole);
      continue;
    }
    uvec_store(share, whole);
    const uint32_t first = slot % CLUSTER;
    if (SIMD_WIDTH < CLUSTER) { /* half a cluster */
      uint32_t all[CLUSTER] = {0};
      memcpy(all + first, share, SIMD_WIDTH * sizeof *all);
      collected_add(collected, slot / CLUSTER, all, sums);
      continue;
    }
    for (uint32_t k = 0; k < SIMD_WIDTH; k += CLUSTER)
      if ((mask >> k & 0xffu) != 0) collected_add(collected, (slot + k) / CLUSTER, share + k, sums);
  }
}

static void density(const struct pass *pass, struct local *local, size_t begin, size_t end) {
  struct particles *p = pass->particles;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, false, &ref);
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref, 0, NULL, 0);
    const size_t walls = pad_columns(local, n, 0);
    n = gather_columns(pass, local, walls, pass->fluid_wall, c, true, &ref, 0, NULL, GATHER_PLACE);
    const size_t all = pad_columns(local, n, 0);
    memset(local->field[LWEIGHT] + walls, 0, (all - walls) * sizeof(float));
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      vec at[3];
      row_position(pass, &ref, l, at);
      p->state[c * CLUSTER + (size_t)l] =
          (float)(1.0 / (pass->w_scale * row_density(local, walls, all, at)));
    }
    spread_density(pass, local, walls);
  }
}

#endif
