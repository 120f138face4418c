/* Counter-based random numbers: Philox 4x32-10 (Salmon, Moraes, Dror, Shaw 2011, "Parallel random
 * numbers: as easy as 1, 2, 3", section 4.3). The numbers of walker w at step s are a function of
 * (w, s) and of the seed alone: the same bits for any number of threads, in any order of walkers,
 * and after a restart, without a stored state. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_RANDOM_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_RANDOM_H

#include <stdint.h>

#define PHILOX_ROUNDS 10
#define PHILOX_MULTIPLIER_0 0xD2511F53u
#define PHILOX_MULTIPLIER_1 0xCD9E8D57u
#define PHILOX_KEY_0 0x9E3779B9u /* increment of the key per round: golden ratio, */
#define PHILOX_KEY_1 0xBB67AE85u /* and square root of 3 minus 1 */

/* Replaces the counter by four random words. */
static inline void philox4x32(uint32_t counter[4], uint32_t key0, uint32_t key1) {
  for (int round = 0; round < PHILOX_ROUNDS; round++) {
    const uint64_t a = (uint64_t)PHILOX_MULTIPLIER_0 * counter[0];
    const uint64_t b = (uint64_t)PHILOX_MULTIPLIER_1 * counter[2];
    counter[0] = (uint32_t)(b >> 32) ^ counter[1] ^ key0;
    counter[1] = (uint32_t)b;
    counter[2] = (uint32_t)(a >> 32) ^ counter[3] ^ key1;
    counter[3] = (uint32_t)a;
    key0 += PHILOX_KEY_0, key1 += PHILOX_KEY_1;
  }
}

/* Uniform in (0, 1), symmetric about 1/2: 24 bits. */
static inline float random_share(uint32_t word) {
  return ((float)(word >> 8) + 0.5f) * 0x1p-24f;
}

#endif
