#include "ct2model/surface/phase_bits.h"

#include <string.h>

#include "common/variants.h"

size_t phase_words(size_t n) {
  return (n + PHASE_WORD - 1) / PHASE_WORD;
}

/* Packs 8 bytes of 0 or 1 into 8 bits. */
static uint64_t gather_bits(const uint8_t *bytes) {
  uint64_t eight;
  memcpy(&eight, bytes, 8);
  return (eight * 0x0102040810204080u) >> 56;
}

TARGETS void phase_row(const int16_t *restrict values, size_t n, uint64_t *restrict bits) {
  for (size_t w = 0; w * PHASE_WORD < n; w++) {
    const int16_t *at = values + w * PHASE_WORD;
    uint8_t bytes[PHASE_WORD];
    if ((w + 1) * PHASE_WORD <= n) {
      for (size_t i = 0; i < PHASE_WORD; i++) bytes[i] = at[i] > 0;
    } else {
      memset(bytes, 0, sizeof bytes);
      for (size_t i = 0; i < n - w * PHASE_WORD; i++) bytes[i] = at[i] > 0;
    }
    bits[w] = 0;
    for (size_t i = 0; i < PHASE_WORD; i += 8) bits[w] |= gather_bits(bytes + i) << i;
  }
}

void phase_next(const uint64_t *bits, size_t n, uint64_t *next) {
  const size_t words = phase_words(n);
  for (size_t w = 0; w < words; w++)
    next[w] = bits[w] >> 1 | (w + 1 < words ? bits[w + 1] << 63 : 0);
  next[words - 1] |= (bits[0] & 1) << (n - 1) % PHASE_WORD;
}

void phase_last(const uint64_t *bits, size_t n, uint64_t *last) {
  const size_t words = phase_words(n);
  const uint64_t end = bits[words - 1] >> (n - 1) % PHASE_WORD & 1;
  for (size_t w = 0; w < words; w++) last[w] = bits[w] << 1 | (w > 0 ? bits[w - 1] >> 63 : end);
  /* Bits after the end of the row are 0. */
  if (n % PHASE_WORD != 0) last[words - 1] &= ((uint64_t)1 << n % PHASE_WORD) - 1;
}
