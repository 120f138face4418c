#include "sphsolve/wcsph/engine/curve.h"

uint32_t curve_key(int dimensions, int bits, const uint32_t coordinate[3]) {
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
