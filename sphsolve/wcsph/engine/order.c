#include "sphsolve/wcsph/engine/order.h"

#include <math.h>
#include <string.h>

/* Position along the Hilbert curve (Skilling 2004, "Programming the Hilbert curve"). */

/* `bits` per coordinate, 2 or 3 coordinates; dimensions * bits <= 32. */
static uint32_t curve_key(int dimensions, int bits, const uint32_t coordinate[3]) {
  uint32_t x[3] = {coordinate[0], coordinate[1], coordinate[2]};
  for (uint32_t q = 1u << (bits - 1); q > 1; q >>= 1) {
    uint32_t p = q - 1;
    for (int i = 0; i < dimensions; i++) {
      if (x[i] & q) { // NOLINT: a scene has two or three dimensions
        x[0] ^= p;
      } else {
        uint32_t t = (x[0] ^ x[i]) & p;
        x[0] ^= t;
        x[i] ^= t;
      }
    }
  }
  for (int i = 1; i < dimensions; i++) x[i] ^= x[i - 1]; // NOLINT: two or three, as above
  uint32_t t = 0;
  for (uint32_t q = 1u << (bits - 1); q > 1; q >>= 1)
    if (x[dimensions - 1] & q) t ^= q - 1;
  for (int i = 0; i < dimensions; i++) x[i] ^= t;
  uint32_t key = 0;
  for (int bit = bits - 1; bit >= 0; bit--)
    for (int i = 0; i < dimensions; i++) key = (key << 1) | ((x[i] >> bit) & 1);
  return key;
}

/* About 22 bits would be enough for locality, but half sites must be distinguished if the box
 * permits it. */
int order_bits(const struct frame *frame) {
  size_t longest = 1;
  for (int a = 0; a < 3; a++)
    if (frame->sites[a] > longest) longest = frame->sites[a];
  int bits = 1, most = frame->dimensions == 2 ? 16 : 10;
  while (bits < most && ((size_t)1 << bits) < 2 * longest) bits++;
  return bits;
}

uint32_t order_key(const struct frame *frame, int bits, const uint32_t cell[3]) {
  size_t longest = frame->sites[0];
  for (int a = 1; a < 3; a++)
    if (frame->sites[a] > longest) longest = frame->sites[a];
  int coarser = 0;
  while ((2 * longest) >> coarser > ((size_t)1 << bits)) coarser++;
  uint32_t c[3] = {cell[0] >> coarser, cell[1] >> coarser, cell[2] >> coarser};
  if (frame->dimensions == 2) c[1] = c[2];
  return curve_key(frame->dimensions, bits, c);
}

void order_sort(uint64_t *entries, uint64_t *scratch, size_t n) {
  for (int shift = 32; shift < 64; shift += 11) {
    size_t start[2049] = {0};
    for (size_t i = 0; i < n; i++) start[((entries[i] >> shift) & 2047) + 1]++;
    for (size_t i = 0; i < 2048; i++) start[i + 1] += start[i];
    for (size_t i = 0; i < n; i++) scratch[start[(entries[i] >> shift) & 2047]++] = entries[i];
    uint64_t *swap = entries;
    entries = scratch;
    scratch = swap;
  }
  memcpy(scratch, entries, n * sizeof *entries); /* after three passes the result is in `scratch` */
}

void cluster_builder_start(struct cluster_builder *builder, const struct frame *frame,
                           double reach) {
  memset(builder, 0, sizeof *builder);
  builder->frame = frame;
  for (int a = 0; a < 3; a++) builder->limit[a] = (int64_t)fmin(reach / frame->unit[a], 0x1p31);
}

bool cluster_builder_takes(struct cluster_builder *builder, const uint32_t x[3]) {
  if (builder->members == CLUSTER) builder->members = 0;
  bool fits = true;
  for (int a = 0; a < 3 && builder->members > 0; a++) {
    int64_t d = (int32_t)(x[a] - builder->first[a]);
    int64_t low = d < builder->low[a] ? d : builder->low[a];
    int64_t high = d > builder->high[a] ? d : builder->high[a];
    fits = fits && high - low <= builder->limit[a];
  }
  if (!fits) builder->members = 0;
  for (int a = 0; a < 3; a++) {
    if (builder->members == 0) {
      builder->first[a] = x[a];
      builder->low[a] = builder->high[a] = 0;
    }
    int64_t d = (int32_t)(x[a] - builder->first[a]);
    if (d < builder->low[a]) builder->low[a] = d;
    if (d > builder->high[a]) builder->high[a] = d;
  }
  builder->members++;
  return fits;
}
