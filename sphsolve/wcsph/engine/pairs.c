#include "sphsolve/wcsph/engine/pairs.h"

#include <stdlib.h>
#include <string.h>

/* Adds two sums at once: they stay below 2^32, so that none overflows into the other. */
void collected_give(struct collected *from, size_t at, uint32_t *sums) {
  uint64_t *to = (uint64_t *)(void *)(sums + (size_t)from->cluster[at] * CLUSTER);
  for (int i = 0; i < CLUSTER / 2; i++) {
    if (from->sum[at][i] != 0) __atomic_fetch_add(&to[i], from->sum[at][i], __ATOMIC_RELAXED);
    from->sum[at][i] = 0;
  }
}

void collected_give_all(struct collected *from, uint32_t *sums) {
  for (size_t at = 0; at < COLLECTED; at++) collected_give(from, at, sums);
}

#define DECLARE(kernel)                                                                            \
  extern const struct pair_table pair_table_##kernel##_baseline, pair_table_##kernel##_avx2,       \
      pair_table_##kernel##_avx512;
#define LIST(kernel)                                                                               \
  { &pair_table_##kernel##_baseline, &pair_table_##kernel##_avx2, &pair_table_##kernel##_avx512 }

/* Each kernel of kernels/ needs two lines. */
DECLARE(quintic)
DECLARE(wendland)
static const struct pair_table *const tables[KERNELS][3] = {
    [KERNEL_QUINTIC] = LIST(quintic),
    [KERNEL_WENDLAND] = LIST(wendland),
};

bool pair_table_exists(enum kernel kernel) {
  return tables[kernel][0] != NULL;
}

enum status pair_table_choose(enum kernel kernel, const struct pair_table **table) {
  const struct pair_table *const *known = tables[kernel];
  bool runs[] = {
      true,
      __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"),
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
          __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"),
  };
  const char *asked = getenv("TOSUI_ISA");
  for (size_t i = 3; i-- > 0;) {
    if (asked != NULL && *asked != '\0' && strcmp(asked, known[i]->name) != 0) continue;
    if (!runs[i] && asked != NULL)
      return FAIL(STATUS_USAGE, "TOSUI_ISA=%s: this machine does not run it", asked);
    if (!runs[i]) continue;
    *table = known[i];
    return STATUS_OK;
  }
  return FAIL(STATUS_USAGE, "TOSUI_ISA=%s: baseline, avx2 or avx512", asked);
}
