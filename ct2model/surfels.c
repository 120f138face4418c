#include "ct2model/surfels.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/phase_bits.h"

enum { BLOCK = 4 };
static const double DISC_RADIUS = 0.71; /* half the diagonal of a cell's face */

/* A disc is two words: its place in the block, three times ten bits, to 1/255 of a cell, and its
 * normal, three times eight bits, to 1/127: errors under 0.006 voxels. */
enum { LANES = 16 };
/* The search is one function for each instruction set. */
#define INLINE __attribute__((always_inline)) static inline

/* Cells that the surface crosses, many at a time. */
enum { CELLS = 64, BITS = BLOCK * BLOCK * BLOCK };
struct cells {
  size_t n;
  uint32_t item;              /* where the first goes in the list; the others follow */
  uint32_t corners[4][CELLS]; /* at y, y + 1 and z, z + 1: two greys of 16 bits, x and x + 1 */
  uint32_t first[CELLS];      /* place of the cell in its block, as a disc's */
};

/* Where an edge from grey a to grey b crosses zero; 0 where it does not. */
#define CROSSED(a, b) (((a) > 0.0f) != ((b) > 0.0f) ? 1.0f : 0.0f)
#define CROSSING(a, b) (((a) > 0.0f) != ((b) > 0.0f) ? (a) / ((a) - (b)) : 0.0f)
#define BILINEAR(u, v, a, b, c, d)                                                                 \
  ((1.0f - (v)) * ((1.0f - (u)) * (a) + (u) * (b)) + (v) * ((1.0f - (u)) * (c) + (u) * (d)))
#define ROUNDED(value) ((int)((value) + 128.5f) - 128)

#define LOW(pair) ((float)(int16_t)(pair))
#define HIGH(pair) ((float)((int32_t)(pair) >> 16))

TARGETS static void make_surfels(const struct cells *cells, const float stretch[3],
                                 uint32_t *restrict places, uint32_t *restrict normals) {
  const float sx = 1.0f / stretch[0], sy = 1.0f / stretch[1], sz = 1.0f / stretch[2];
  for (size_t i = 0; i < CELLS; i++) {
    const uint32_t ab = cells->corners[0][i], cd = cells->corners[1][i], ef = cells->corners[2][i],
                   gh = cells->corners[3][i];
    const float a = LOW(ab), b = HIGH(ab), c = LOW(cd), d = HIGH(cd), e = LOW(ef), f = HIGH(ef),
                g = LOW(gh), h = HIGH(gh);
    /* Edges along x, y, z, each from the corner with fewer ones. */
    const float x0 = CROSSED(a, b), x1 = CROSSED(c, d), x2 = CROSSED(e, f), x3 = CROSSED(g, h);
    const float y0 = CROSSED(a, c), y1 = CROSSED(b, d), y2 = CROSSED(e, g), y3 = CROSSED(f, h);
    const float z0 = CROSSED(a, e), z1 = CROSSED(b, f), z2 = CROSSED(c, g), z3 = CROSSED(d, h);
    float n = x0 + x1 + x2 + x3 + y0 + y1 + y2 + y3 + z0 + z1 + z2 + z3;
    n = n > 0.0f ? 1.0f / n : 1.0f;
    const float x =
        n * (CROSSING(a, b) + CROSSING(c, d) + CROSSING(e, f) + CROSSING(g, h) + y1 + y3 + z1 + z3);
    const float y =
        n * (CROSSING(a, c) + CROSSING(b, d) + CROSSING(e, g) + CROSSING(f, h) + x1 + x3 + z2 + z3);
    const float z =
        n * (CROSSING(a, e) + CROSSING(b, f) + CROSSING(c, g) + CROSSING(d, h) + x2 + x3 + y2 + y3);
    /* The gradient there: along an axis, bilinear between its four edges. */
    const float dx = sx * BILINEAR(y, z, b - a, d - c, f - e, h - g);
    const float dy = sy * BILINEAR(x, z, c - a, d - b, g - e, h - f);
    const float dz = sz * BILINEAR(x, y, e - a, f - b, g - c, h - d);
    const float square = dx * dx + dy * dy + dz * dz;
    const float unit = 127.0f / (square > 0.0f ? sqrtf(square) : 1.0f);
    const int px = (int)(255.0f * x + 0.5f), py = (int)(255.0f * y + 0.5f),
              pz = (int)(255.0f * z + 0.5f);
    const int nx = ROUNDED(unit * dx), ny = ROUNDED(unit * dy), nz = ROUNDED(unit * dz);
    places[i] = cells->first[i] + (uint32_t)(px | py << 10 | pz << 20);
    normals[i] = (uint32_t)((nx & 255) | (ny & 255) << 8 | (nz & 255) << 16);
  }
}

static void flush_cells(struct cells *cells, struct surfels *surfels) {
  const float stretch[3] = {(float)surfels->stretch[0], (float)surfels->stretch[1],
                            (float)surfels->stretch[2]};
  uint32_t places[CELLS], normals[CELLS];
  make_surfels(cells, stretch, places, normals);
  memcpy(surfels->items + cells->item, places, cells->n * sizeof *places);
  memcpy(surfels->items + surfels->pitch + cells->item, normals, cells->n * sizeof *normals);
  cells->item += (uint32_t)cells->n;
  cells->n = 0;
}

/* What a thread needs for a row of blocks. */
struct scratch {
  uint64_t *any, *all, *next; /* of a row of bits */
  uint64_t *crossed;          /* of the BLOCK * BLOCK rows of cells */
  struct cells cells;
};

/* The cells whose eight corners disagree, for all x of the row y, z. */
static void row_crossings(const uint64_t *bits, const size_t size[3], size_t y, size_t z,
                          struct scratch *scratch, uint64_t *crossed) {
  const size_t nx = size[0], ny = size[1], words = phase_words(nx), next = y + 1 < ny ? y + 1 : 0;
  const uint64_t *a = bits + (z * ny + y) * words, *b = bits + (z * ny + next) * words;
  const uint64_t *c = a + ny * words, *d = b + ny * words;
  for (size_t w = 0; w < words; w++) {
    scratch->any[w] = a[w] | b[w] | c[w] | d[w];
    scratch->all[w] = a[w] & b[w] & c[w] & d[w];
  }
  phase_next(scratch->any, nx, scratch->next);
  for (size_t w = 0; w < words; w++) crossed[w] = scratch->any[w] | scratch->next[w];
  phase_next(scratch->all, nx, scratch->next);
  for (size_t w = 0; w < words; w++) crossed[w] &= ~(scratch->all[w] & scratch->next[w]);
}

/* Bit BLOCK * r + x of blocks[b]: bit BLOCK * b + x of rows[r][word]. */
TARGETS static void gather_blocks(const uint64_t *rows, size_t words, size_t word,
                                  uint64_t blocks[PHASE_WORD / BLOCK]) {
  for (unsigned b = 0; b < PHASE_WORD / BLOCK; b++) blocks[b] = 0;
  for (unsigned r = 0; r < BLOCK * BLOCK; r++) {
    const uint64_t row = rows[r * words + word];
    for (unsigned b = 0; b < PHASE_WORD / BLOCK; b++)
      blocks[b] |= (row >> BLOCK * b & 15u) << BLOCK * r;
  }
}

/* The crossed cells of one layer of blocks, and how many they are. */
static void find_layer(const uint64_t *bits, struct surfels *surfels, size_t bz,
                       struct scratch *scratch) {
  const size_t *size = surfels->size, *blocks = surfels->blocks, words = phase_words(size[0]);
  for (size_t by = 0; by < blocks[1]; by++) {
    const size_t first = (bz * blocks[1] + by) * blocks[0];
    memset(scratch->crossed, 0, BLOCK * BLOCK * words * sizeof *scratch->crossed);
    for (size_t r = 0; r < BLOCK * BLOCK; r++) {
      const size_t y = by * BLOCK + r % BLOCK, z = bz * BLOCK + r / BLOCK;
      if (y < size[1] && z + 1 < size[2])
        row_crossings(bits, size, y, z, scratch, scratch->crossed + r * words);
    }
    for (size_t w = 0; w < words; w++) {
      uint64_t some[PHASE_WORD / BLOCK];
      gather_blocks(scratch->crossed, words, w, some);
      for (size_t b = 0; b < PHASE_WORD / BLOCK && w * PHASE_WORD / BLOCK + b < blocks[0]; b++) {
        const size_t at = w * PHASE_WORD / BLOCK + b, block = first + at;
        surfels->crossed[block] = some[b];
        surfels->first[block + 1] = (uint32_t)__builtin_popcountll(some[b]);
        surfels->occupied[first / blocks[0] * surfels->words + at / PHASE_WORD] |=
            (uint64_t)(some[b] != 0) << at % PHASE_WORD;
      }
    }
  }
}

static uint32_t two_greys(const int16_t *at) {
  uint32_t pair;
  memcpy(&pair, at, sizeof pair);
  return pair;
}

/* Where a cell of a block is: in the field, and as a disc's place. */
struct cell_place {
  size_t x, y, z, offset;
  uint32_t first;
};

static void fill_block(const int16_t *field, struct surfels *surfels, const size_t at[3],
                       const struct cell_place places[BITS], struct cells *cells) {
  const size_t *size = surfels->size, nx = size[0], plane = nx * size[1];
  const size_t block = (at[2] * surfels->blocks[1] + at[1]) * surfels->blocks[0] + at[0];
  const int16_t *corner = field + at[2] * BLOCK * plane + at[1] * BLOCK * nx + at[0] * BLOCK;
  const bool inside = (at[0] + 1) * BLOCK < nx && (at[1] + 1) * BLOCK < size[1];
  for (uint64_t open = surfels->crossed[block]; open != 0; open &= open - 1) {
    const struct cell_place *place = &places[__builtin_ctzll(open)];
    const int16_t *here = corner + place->offset, *next = here + nx;
    const size_t i = cells->n++;
    cells->first[i] = place->first;
    if (inside) {
      cells->corners[0][i] = two_greys(here);
      cells->corners[1][i] = two_greys(next);
      cells->corners[2][i] = two_greys(here + plane);
      cells->corners[3][i] = two_greys(next + plane);
    } else {
      const size_t x = at[0] * BLOCK + place->x, y = at[1] * BLOCK + place->y;
      const size_t right = x + 1 < nx ? 1 : 0; /* else the row's first */
      if (y + 1 == size[1]) next = here - y * nx;
      for (unsigned c = 0; c < 4; c++) {
        const int16_t *row = (c % 2 == 0 ? here : next) + c / 2 * plane;
        const uint16_t low = (uint16_t)row[0];
        const uint16_t high = (uint16_t)(right != 0 ? row[1] : *(row - x));
        cells->corners[c][i] = low | (uint32_t)high << 16;
      }
    }
    if (cells->n == CELLS) flush_cells(cells, surfels);
  }
}

static void fill_layer(const int16_t *field, struct surfels *surfels, size_t bz,
                       struct cells *cells) {
  struct cell_place places[BITS];
  for (size_t i = 0; i < BITS; i++) {
    struct cell_place *place = &places[i];
    *place = (struct cell_place){.x = i % BLOCK, .y = i / BLOCK % BLOCK, .z = i / BLOCK / BLOCK};
    place->offset = (place->z * surfels->size[1] + place->y) * surfels->size[0] + place->x;
    place->first = (uint32_t)(255 * (place->x | place->y << 10 | place->z << 20));
  }
  cells->n = 0;
  cells->item = surfels->first[bz * surfels->blocks[1] * surfels->blocks[0]];
  for (size_t by = 0; by < surfels->blocks[1]; by++)
    for (size_t bx = 0; bx < surfels->blocks[0]; bx++)
      fill_block(field, surfels, (size_t[3]){bx, by, bz}, places, cells);
  if (cells->n > 0) flush_cells(cells, surfels);
}

static enum status scratch_start(size_t words, size_t threads, struct scratch **scratch) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(scratch, threads, sizeof **scratch, "surface rows"));
  for (size_t i = 0; i < threads; i++) {
    struct scratch *one = *scratch + i;
    TRY(memory_allocate(&one->any, (3 + BLOCK * BLOCK) * words, sizeof *one->any, "surface rows"));
    one->all = one->any + words;
    one->next = one->all + words;
    one->crossed = one->next + words;
  }
cleanup:
  return status;
}

static void scratch_end(size_t threads, struct scratch **scratch) {
  for (size_t i = 0; i < threads && *scratch != NULL; i++) memory_free(&(*scratch)[i].any);
  memory_free(scratch);
}

enum status surfels_build(const int16_t *field, const uint64_t *bits, const size_t size[3],
                          const double stretch[3], struct surfels *surfels) {
  enum status status = STATUS_OK;
  struct scratch *scratch = NULL;
  const size_t threads = (size_t)omp_get_max_threads();
  memset(surfels, 0, sizeof *surfels);
  memcpy(surfels->size, size, sizeof surfels->size);
  memcpy(surfels->stretch, stretch, sizeof surfels->stretch);
  for (int d = 0; d < 3; d++) surfels->blocks[d] = (size[d] + BLOCK - 1) / BLOCK;
  size_t blocks = surfels->blocks[0] * surfels->blocks[1] * surfels->blocks[2];
  size_t layers = surfels->blocks[2];
  TRY(memory_allocate(&surfels->crossed, blocks, sizeof *surfels->crossed, "surface blocks"));
  TRY(memory_allocate(&surfels->first, blocks + 1, sizeof *surfels->first, "surface blocks"));
  surfels->words = phase_words(surfels->blocks[0]);
  TRY(memory_allocate(&surfels->occupied, surfels->words * surfels->blocks[1] * layers,
                      sizeof *surfels->occupied, "surface blocks"));
  TRY(scratch_start(phase_words(size[0]), threads, &scratch));
#pragma omp parallel for schedule(dynamic)
  for (size_t bz = 0; bz < layers; bz++)
    find_layer(bits, surfels, bz, scratch + omp_get_thread_num());
  uint64_t total = 0;
  for (size_t b = 0; b <= blocks; b++) {
    total += surfels->first[b];
    if (total > UINT32_MAX) TRY_FAIL(STATUS_RUN, "the grain surface has too many facets");
    surfels->first[b] = (uint32_t)total;
  }
  surfels->count = (size_t)total;
  if (total == 0) goto cleanup;
  surfels->pitch = surfels->count + LANES; /* whole vectors are read */
  TRY(memory_allocate(&surfels->items, 2 * surfels->pitch, sizeof *surfels->items,
                      "the grain surface"));
#pragma omp parallel for schedule(dynamic)
  for (size_t bz = 0; bz < layers; bz++)
    fill_layer(field, surfels, bz, &scratch[omp_get_thread_num()].cells);
cleanup:
  scratch_end(threads, &scratch);
  if (status != STATUS_OK) surfels_end(surfels);
  return status;
}

void surfels_end(struct surfels *surfels) {
  memory_free(&surfels->crossed);
  memory_free(&surfels->first);
  memory_free(&surfels->items);
  memory_free(&surfels->occupied);
  surfels->count = 0;
}

/* Squared distance to the nearest of n discs; `point` from the first cell's first corner. Squares
 * are compared by their bits, which for positive floats rise with the value. */
INLINE float nearest_disc(const uint32_t *restrict places, const uint32_t *restrict normals, int n,
                          const float point[3], const float stretch[3]) {
  const float x0 = point[0], y0 = point[1], z0 = point[2], radius = (float)DISC_RADIUS;
  const float sx = stretch[0] / 255.0f, sy = stretch[1] / 255.0f, sz = stretch[2] / 255.0f;
  union {
    float value;
    int32_t bits;
  } least = {INFINITY};
  const int end = (n + LANES - 1) / LANES * LANES;
  for (int i = 0; i < end; i++) {
    const uint32_t place = places[i], normal = normals[i];
    const float x = x0 - sx * (float)(int)(place & 1023u);
    const float y = y0 - sy * (float)(int)(place >> 10 & 1023u);
    const float z = z0 - sz * (float)(int)(place >> 20 & 1023u);
    const float height =
        (x * (float)((int)(normal << 24) >> 24) + y * (float)((int)(normal << 16) >> 24) +
         z * (float)((int)(normal << 8) >> 24)) *
        (1.0f / 127.0f);
    const float aside = x * x + y * y + z * z - height * height;
    const float over = sqrtf(aside > 0.0f ? aside : 0.0f) - radius;
    const float beyond = over > 0.0f ? over : 0.0f;
    union {
      float value;
      int32_t bits;
    } square = {height * height + beyond * beyond};
    const int32_t bits = i < n ? square.bits : INT32_MAX;
    least.bits = bits < least.bits ? bits : least.bits;
  }
  return least.value;
}

/* The search for the disc nearest to a point. */
struct search {
  const struct surfels *surfels;
  double point[3], best;
  double cell[3]; /* the point in cells from the first one */
  float stretch[3];
  size_t near; /* the block of the best */
};

INLINE void look_at(struct search *search, size_t block, const size_t at[3]) {
  const struct surfels *surfels = search->surfels;
  const uint32_t first = surfels->first[block], end = surfels->first[block + 1];
  float local[3];
  for (int d = 0; d < 3; d++)
    local[d] = (float)(search->point[d] - ((double)(at[d] * BLOCK) + 0.5) * surfels->stretch[d]);
  const float square = nearest_disc(surfels->items + first, surfels->items + surfels->pitch + first,
                                    (int)(end - first), local, search->stretch);
  if (!((double)square < search->best * search->best)) return;
  search->best = sqrt((double)square);
  search->near = block;
}

/* No disc reaches farther from its cell; a little more than its radius for rounding. */
INLINE double bound_of(const struct search *search) {
  return search->best + DISC_RADIUS + 1e-3;
}

/* From `at`, in cells, to the interval low .. high. */
INLINE double gap_of(double at, double low, double high, double stretch) {
  const double below = low - at, above = at - high, gap = below > above ? below : above;
  return gap > 0.0 ? gap * stretch : 0.0;
}

/* Square of the distance from a point, in cells from the block's first, to the box around the
 * crossed cells of a block. */
INLINE double box_gap(uint64_t crossed, const double at[3], const double stretch[3]) {
  /* For each axis whether a cell's place along it, 0 to BLOCK - 1, is crossed: every bit, every
   * fourth, every sixteenth. */
  const uint64_t yz = (crossed | crossed >> 1 | crossed >> 2 | crossed >> 3) & 0x1111111111111111u;
  const uint64_t z = (yz | yz >> 4 | yz >> 8 | yz >> 12) & 0x0001000100010001u;
  const uint64_t layers = crossed | crossed >> 32, layer = layers | layers >> 16;
  const unsigned x = (unsigned)(layer | layer >> 4 | layer >> 8 | layer >> 12) & 15u;
  const uint64_t rows = yz | yz >> 32;
  const unsigned y = (unsigned)(rows | rows >> 16) & 0x1111u;
  const double gx = gap_of(at[0], __builtin_ctz(x), 32 - __builtin_clz(x), stretch[0]);
  const double gy = gap_of(at[1], __builtin_ctz(y) >> 2, 8 - (__builtin_clz(y) >> 2), stretch[1]);
  const double gz =
      gap_of(at[2], __builtin_ctzll(z) >> 4, 4 - (__builtin_clzll(z) >> 4), stretch[2]);
  return gx * gx + gy * gy + gz * gz;
}

/* The blocks of a row from `low` to `high` in which a disc may be nearer. */
INLINE void look_along(struct search *search, long y, long z, long low, long high) {
  const struct surfels *surfels = search->surfels;
  const size_t row = (size_t)z * surfels->blocks[1] + (size_t)y;
  for (long w = low / PHASE_WORD; w <= high / PHASE_WORD; w++) {
    uint64_t open = surfels->occupied[row * surfels->words + (size_t)w];
    if (low > w * PHASE_WORD) open &= ~(uint64_t)0 << (low - w * PHASE_WORD);
    if (high < w * PHASE_WORD + PHASE_WORD - 1)
      open &= ~(~(uint64_t)0 << (high - w * PHASE_WORD + 1));
    for (; open != 0; open &= open - 1) {
      const long x = w * PHASE_WORD + __builtin_ctzll(open);
      const size_t block = row * surfels->blocks[0] + (size_t)x;
      const double bound = bound_of(search);
      const double inside[3] = {search->cell[0] - (double)(x * BLOCK),
                                search->cell[1] - (double)(y * BLOCK),
                                search->cell[2] - (double)(z * BLOCK)};
      if (block != search->near &&
          box_gap(surfels->crossed[block], inside, surfels->stretch) <= bound * bound)
        look_at(search, block, (size_t[3]){(size_t)x, (size_t)y, (size_t)z});
    }
  }
}

/* First and last block along one axis that lie within `reach` cells of the point. */
INLINE void block_range(const struct search *search, int axis, double reach, long range[2]) {
  const long last = (long)search->surfels->blocks[axis] - 1;
  range[0] = (long)floor((search->cell[axis] - reach) * (1.0 / BLOCK));
  range[1] = (long)floor((search->cell[axis] + reach) * (1.0 / BLOCK));
  if (range[0] < 0) range[0] = 0;
  if (range[1] > last) range[1] = last;
}

/* Step k of 0, 1, ... from `home` through first .. last, near ones first; false behind the end. */
INLINE bool step_out(long home, const long range[2], long k, long *at) {
  home = home < range[0] ? range[0] : home > range[1] ? range[1] : home;
  const long down = home - range[0], up = range[1] - home, both = down < up ? down : up;
  if (k > down + up) return false;
  if (k <= 2 * both)
    *at = (k & 1) == 0 ? home + (k >> 1) : home - ((k + 1) >> 1);
  else
    *at = up > down ? home + k - both : home - (k - both);
  return true;
}

INLINE void search_blocks(struct search *search) {
  const struct surfels *surfels = search->surfels;
  const double *stretch = surfels->stretch;
  long ys[2], zs[2], xs[2], home[3], y, z;
  for (int d = 0; d < 3; d++) {
    search->cell[d] = search->point[d] / stretch[d] - 0.5;
    home[d] = (long)floor(search->cell[d] * (1.0 / BLOCK));
  }
  const double unit = 1.0 / stretch[0];
  block_range(search, 2, bound_of(search) / stretch[2], zs);
  block_range(search, 1, bound_of(search) / stretch[1], ys);
  if (zs[0] > zs[1] || ys[0] > ys[1]) return;
  for (long k = 0; step_out(home[2], zs, k, &z); k++) {
    const double z0 = (double)(z * BLOCK);
    const double gz = gap_of(search->cell[2], z0, z0 + BLOCK, stretch[2]);
    if (gz > bound_of(search)) continue;
    for (long j = 0; step_out(home[1], ys, j, &y); j++) {
      const double y0 = (double)(y * BLOCK);
      const double gy = gap_of(search->cell[1], y0, y0 + BLOCK, stretch[1]);
      const double bound = bound_of(search), left = bound * bound - gz * gz - gy * gy;
      if (left < 0.0) continue;
      block_range(search, 0, sqrt(left) * unit, xs);
      if (xs[0] <= xs[1]) look_along(search, y, z, xs[0], xs[1]);
    }
  }
}

TARGETS double surfels_distance(const struct surfels *surfels, const double point[3], double limit,
                                size_t *near) {
  const size_t *n = surfels->blocks;
  const double *stretch = surfels->stretch;
  if (surfels->count == 0) return limit;
  struct search search = {.surfels = surfels,
                          .point = {point[0], point[1], point[2]},
                          .best = limit,
                          .stretch = {(float)stretch[0], (float)stretch[1], (float)stretch[2]},
                          .near = SURFELS_NOWHERE};
  if (*near != SURFELS_NOWHERE)
    look_at(&search, *near, (size_t[3]){*near % n[0], *near / n[0] % n[1], *near / n[0] / n[1]});
  search_blocks(&search);
  double period[2], low[2], high[2]; /* cells lie between 1/2 and size + 1/2 */
  bool inside = true;
  for (int d = 0; d < 2; d++) {
    period[d] = (double)surfels->size[d] * stretch[d];
    low[d] = 0.5 * stretch[d];
    high[d] = low[d] + period[d];
    inside &= point[d] - low[d] > bound_of(&search) && high[d] - point[d] > bound_of(&search);
  }
  for (int i = 0; i < 9 && !inside; i++) {
    const int ix = i % 3 - 1, iy = i / 3 - 1;
    if (i == 4) continue;
    search.point[0] = point[0] + ix * period[0];
    search.point[1] = point[1] + iy * period[1];
    double gap = 0.0;
    for (int d = 0; d < 2; d++) {
      double out = fmax(0.0, fmax(low[d] - search.point[d], search.point[d] - high[d]));
      gap += out * out;
    }
    if (gap < bound_of(&search) * bound_of(&search)) search_blocks(&search);
  }
  *near = search.near;
  return search.best;
}
