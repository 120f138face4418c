/* Order of particles along the Hilbert curve, and its division into clusters. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ORDER_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ORDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sphsolve/wcsph/engine/frame.h"

/* Bits of a key per coordinate. */
int order_bits(const struct frame *frame);
/* Key of a position along the curve; `cell`: the position in half sites. */
uint32_t order_key(const struct frame *frame, int bits, const uint32_t cell[3]);
/* Sorts entries by their upper 32 bits, stably; `scratch` has the same size. */
void order_sort(uint64_t *entries, uint64_t *scratch, size_t n);

/* Builds clusters one member at a time; cluster_builder_takes returns false if the member would
 * make the cluster too wide and so begins the next one. */
struct cluster_builder {
  const struct frame *frame;
  int64_t limit[3];
  uint32_t first[3];
  int64_t low[3], high[3];
  int members;
};
void cluster_builder_start(struct cluster_builder *builder, const struct frame *frame,
                           double reach);
bool cluster_builder_takes(struct cluster_builder *builder, const uint32_t x[3]);

#endif
