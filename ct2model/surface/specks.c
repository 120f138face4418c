#include "ct2model/surface/specks.h"

#include <omp.h>
#include <stdbool.h>
#include <string.h>

#include "common/variants.h"

enum { WORD = PHASE_WORD, SIDE = 4, TABLE = 256 };

/* One phase of the slab as bits. A cube of SIDE^3 voxels is larger than a speck, and so is all that
 * is connected to one: `large` grows from such cubes through the phase, as far as two passes carry
 * it. Few voxels remain, and from each of these its island is followed until it is known to be a
 * speck or not. */
struct phase {
  int16_t *field;
  uint64_t *grain;              /* the bits of the slab, which are changed */
  size_t size[3], words, limit; /* words a row */
  uint64_t *bits, *large;
};

/* Bit i is set if bits i to i + SIDE - 1 of the row are. */
TARGETS static void erode_row(const uint64_t *restrict bits, size_t words, uint64_t *restrict out) {
  for (size_t w = 0; w < words; w++) {
    const uint64_t at = bits[w], next = w + 1 < words ? bits[w + 1] : 0;
    const uint64_t two = at & (at >> 1 | next << 63), two_next = next & next >> 1;
    out[w] = two & (two >> 2 | two_next << 62);
  }
}

TARGETS static void and_rows(uint64_t *restrict row, const uint64_t *restrict a,
                             const uint64_t *restrict b, const uint64_t *restrict c, size_t words) {
  for (size_t w = 0; w < words; w++) row[w] &= a[w] & b[w] & c[w];
}

static uint64_t *row_of(uint64_t *bits, const struct phase *phase, size_t y, size_t z) {
  return bits + (z * phase->size[1] + y) * phase->words;
}

/* Intersects a row with the SIDE - 1 rows after it, a stride apart; clears it where these would
 * leave the slab. */
static void erode_across(uint64_t *row, size_t stride, size_t words, bool inside) {
  if (inside)
    and_rows(row, row + stride, row + 2 * stride, row + 3 * stride, words);
  else
    memset(row, 0, words * sizeof *row);
}

/* The lowest corners of all cubes of the phase. */
static void find_cubes(const struct phase *phase) {
  const size_t ny = phase->size[1], nz = phase->size[2], words = phase->words;
#pragma omp parallel for schedule(static)
  for (size_t z = 0; z < nz; z++) {
    for (size_t y = 0; y < ny; y++)
      erode_row(row_of(phase->bits, phase, y, z), words, row_of(phase->large, phase, y, z));
    for (size_t y = 0; y < ny; y++)
      erode_across(row_of(phase->large, phase, y, z), words, words, y + SIDE <= ny);
  }
#pragma omp parallel for schedule(static)
  for (size_t y = 0; y < ny; y++)
    for (size_t z = 0; z < nz; z++)
      erode_across(row_of(phase->large, phase, y, z), ny * words, words, z + SIDE <= nz);
}

/* The bits of `mask` that are connected to `seed` within the word, in both directions. */
static uint64_t fill_word(uint64_t seed, uint64_t mask) {
  uint64_t up = mask, down = mask;
  for (unsigned step = 1; step < WORD; step *= 2) {
    seed |= (up & seed << step) | (down & seed >> step);
    up &= up << step;
    down &= down >> step;
  }
  return seed;
}

static void grow_row(uint64_t *large, const uint64_t *bits, const uint64_t *beside,
                     const uint64_t *before, size_t words) {
  uint64_t carry = 0;
  for (size_t w = 0; w < words; w++) {
    const uint64_t more = (beside[w] | before[w] | carry) & bits[w] & ~large[w];
    if (more != 0) large[w] = fill_word(large[w] | more, bits[w]);
    carry = large[w] >> 63;
  }
}

static void grow_large(const struct phase *phase) {
  const size_t ny = phase->size[1], nz = phase->size[2], parts = (size_t)omp_get_max_threads();
#pragma omp parallel for schedule(static, 1)
  for (size_t part = 0; part < parts; part++) {
    const size_t first = nz * part / parts, end = nz * (part + 1) / parts;
    for (size_t i = 0; i < 2 * (end - first); i++) {
      const bool back = i >= end - first;
      const size_t z = back ? 2 * end - first - 1 - i : first + i;
      const size_t last = back ? z + 1 < end ? z + 1 : z : z > first ? z - 1 : z;
      for (size_t k = 0; k < ny; k++) {
        const size_t y = back ? ny - 1 - k : k, beside = back ? (y + 1) % ny : (y + ny - 1) % ny;
        grow_row(row_of(phase->large, phase, y, z), row_of(phase->bits, phase, y, z),
                 row_of(phase->large, phase, beside, z), row_of(phase->large, phase, y, last),
                 phase->words);
      }
    }
  }
}

static bool has_bit(const uint64_t *bits, const struct phase *phase, size_t x, size_t y, size_t z) {
  return bits[(z * phase->size[1] + y) * phase->words + x / WORD] >> x % WORD & 1;
}

struct island {
  size_t n, voxel[SPECK_MOST];
  size_t seen[TABLE]; /* hash table of voxel + 1; 0: empty */
};

static bool insert_voxel(struct island *island, size_t voxel) {
  size_t slot = voxel * 0x9e3779b97f4a7c15u >> 56;
  while (island->seen[slot] != 0 && island->seen[slot] != voxel + 1) slot = (slot + 1) % TABLE;
  const bool found = island->seen[slot] == 0;
  island->seen[slot] = voxel + 1;
  return found;
}

/* Collects the island of voxel `start`; false if it is no speck, or contains a voxel before
 * `start`, from which it is found as well. */
static bool collect_island(const struct phase *phase, size_t start, struct island *island) {
  const size_t *n = phase->size;
  island->n = 0;
  memset(island->seen, 0, sizeof island->seen);
  (void)insert_voxel(island, start);
  island->voxel[island->n++] = start;
  for (size_t i = 0; i < island->n; i++) {
    const size_t x = island->voxel[i] % n[0], y = island->voxel[i] / n[0] % n[1],
                 z = island->voxel[i] / n[0] / n[1];
    if (z == 0 || z + 1 == n[2]) return false;
    const size_t next[6][3] = {{x > 0 ? x - 1 : n[0] - 1, y, z},
                               {x + 1 < n[0] ? x + 1 : 0, y, z},
                               {x, y > 0 ? y - 1 : n[1] - 1, z},
                               {x, y + 1 < n[1] ? y + 1 : 0, z},
                               {x, y, z - 1},
                               {x, y, z + 1}};
    for (int k = 0; k < 6; k++) {
      const size_t *p = next[k], voxel = (p[2] * n[1] + p[1]) * n[0] + p[0];
      if (!has_bit(phase->bits, phase, p[0], p[1], p[2])) continue;
      if (voxel < start || has_bit(phase->large, phase, p[0], p[1], p[2])) return false;
      if (!insert_voxel(island, voxel)) continue;
      if (island->n + 1 >= phase->limit) return false;
      island->voxel[island->n++] = voxel;
    }
  }
  return true;
}

static size_t flip_islands(const struct phase *phase, size_t y, size_t z, struct island *island) {
  const uint64_t *bits = row_of(phase->bits, phase, y, z),
                 *large = row_of(phase->large, phase, y, z);
  const size_t row = (z * phase->size[1] + y) * phase->size[0];
  size_t changed = 0;
  for (size_t w = 0; w < phase->words; w++) {
    /* A voxel whose left neighbour, in this word, is of the island is reached from there. */
    for (uint64_t open = bits[w] & ~large[w] & ~(bits[w] << 1); open != 0; open &= open - 1) {
      if (!collect_island(phase, row + w * WORD + (size_t)__builtin_ctzll(open), island)) continue;
      for (size_t i = 0; i < island->n; i++) {
        const size_t voxel = island->voxel[i], x = voxel % phase->size[0];
        int16_t *at = &phase->field[voxel];
        *at = (int16_t)(*at == 0 ? 1 : -*at);
        __atomic_fetch_xor(&phase->grain[voxel / phase->size[0] * phase->words + x / WORD],
                           (uint64_t)1 << x % WORD, __ATOMIC_RELAXED);
      }
      changed += island->n;
    }
  }
  return changed;
}

/* Copies the bits of one phase, which stay unchanged while islands are removed. */
static void copy_phase(const struct phase *phase, bool grain) {
  const size_t nx = phase->size[0], words = phase->words, rows = phase->size[1] * phase->size[2];
  const uint64_t all = ~(uint64_t)0, end = nx % WORD != 0 ? ((uint64_t)1 << nx % WORD) - 1 : all;
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < rows; row++)
    for (size_t w = 0; w < words; w++)
      phase->bits[row * words + w] =
          (phase->grain[row * words + w] ^ (grain ? 0 : all)) & (w + 1 < words ? all : end);
}

size_t specks_remove(int16_t *field, uint64_t *bits, const size_t size[3], size_t limit,
                     uint64_t *scratch) {
  const size_t rows = size[1] * size[2], words = phase_words(size[0]);
  const struct phase phase = {.field = field,
                              .grain = bits,
                              .size = {size[0], size[1], size[2]},
                              .words = words,
                              .limit = limit,
                              .bits = scratch,
                              .large = scratch + rows * words};
  size_t sum = 0;
  for (int grain = 0; grain < 2; grain++) {
    copy_phase(&phase, grain != 0);
    find_cubes(&phase);
    grow_large(&phase);
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : sum)
    for (size_t row = 0; row < rows; row++) {
      struct island island;
      sum += flip_islands(&phase, row % size[1], row / size[1], &island);
    }
  }
  return sum;
}

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
