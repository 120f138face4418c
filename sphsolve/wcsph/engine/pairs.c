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

/* The Makefile says which instruction sets it has compiled the pair loops for: -DPAIR_ISAS=mask. */
enum { BASELINE, AVX2, AVX512, ISAS };
#ifndef PAIR_ISAS
#define PAIR_ISAS 7
#endif
static const char *const isa_names[ISAS] = {"baseline", "avx2", "avx512"};

#if PAIR_ISAS & 1
#define BUILT_BASELINE(table) &table
#else
#define BUILT_BASELINE(table) NULL
#endif
#if PAIR_ISAS & 2
#define BUILT_AVX2(table) &table
#else
#define BUILT_AVX2(table) NULL
#endif
#if PAIR_ISAS & 4
#define BUILT_AVX512(table) &table
#else
#define BUILT_AVX512(table) NULL
#endif

#define DECLARE(kernel)                                                                            \
  extern const struct pair_table pair_table_##kernel##_baseline, pair_table_##kernel##_avx2,       \
      pair_table_##kernel##_avx512;
#define LIST(kernel)                                                                               \
  {                                                                                                \
    BUILT_BASELINE(pair_table_##kernel##_baseline), BUILT_AVX2(pair_table_##kernel##_avx2),        \
        BUILT_AVX512(pair_table_##kernel##_avx512)                                                 \
  }

/* Each kernel of kernels/ needs two lines. */
DECLARE(quintic)
DECLARE(wendland)
static const struct pair_table *const tables[KERNELS][ISAS] = {
    [KERNEL_QUINTIC] = LIST(quintic),
    [KERNEL_WENDLAND] = LIST(wendland),
};

bool pair_table_exists(enum kernel kernel) {
  for (int i = 0; i < ISAS; i++)
    if (tables[kernel][i] != NULL) return true;
  return false;
}

bool pair_isa_is_built(const char *name) {
  for (int i = 0; i < ISAS; i++)
    if (strcmp(name, isa_names[i]) == 0) return (PAIR_ISAS >> i & 1) != 0;
  return false;
}

enum status pair_table_choose(enum kernel kernel, const struct pair_table **table) {
  const bool runs[ISAS] = {
      true,
      __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"),
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
          __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw"),
  };
  const char *asked = getenv("TOSUI_ISA");
  if (asked != NULL && *asked == '\0') asked = NULL;
  for (int i = ISAS; i-- > 0;) {
    if (asked != NULL && strcmp(asked, isa_names[i]) != 0) continue;
    if (asked != NULL && !runs[i])
      return FAIL(STATUS_USAGE, "TOSUI_ISA=%s: this machine does not run it", asked);
    if (asked != NULL && tables[kernel][i] == NULL)
      return FAIL(STATUS_USAGE, "TOSUI_ISA=%s: not built for it; make ISAS=all does", asked);
    if (!runs[i] || tables[kernel][i] == NULL) continue;
    *table = tables[kernel][i];
    return STATUS_OK;
  }
  if (asked != NULL) return FAIL(STATUS_USAGE, "TOSUI_ISA=%s: baseline, avx2 or avx512", asked);
  return FAIL(STATUS_USAGE,
              "method wcsph was built for another processor than this machine's; make "
              "ISAS=all builds it for any");
}
