#include "ct2model/surface/surfels.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/surface/specks.h"

enum { BLOCK = SURFELS_BLOCK };

/* A batch of cells that the surface crosses. */
enum { CELLS = 64, BITS = BLOCK * BLOCK * BLOCK };
struct cells {
  size_t n;
  uint32_t item;              /* index of the first one in the list; the others follow */
  uint32_t corners[4][CELLS]; /* at y, y + 1 and z, z + 1: the two 16-bit greys at x and x + 1 */
  uint32_t first[CELLS];      /* place of the cell in its block, encoded like that of a disc */
};

/* Position at which an edge from grey a to grey b crosses zero; 0 if it does not. */
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
    /* The gradient there: each component is bilinear between the four edges along its axis. */
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
  memcpy(surfels->items + surfels->count + cells->item, normals, cells->n * sizeof *normals);
  cells->item += (uint32_t)cells->n;
  cells->n = 0;
}

/* Work space of a thread for a row of blocks. */
struct scratch {
  uint64_t *any, *all, *next; /* rows of bits */
  uint64_t *crossed;          /* bits of the BLOCK * BLOCK rows of cells */
  struct cells cells;
};

/* Bits of the cells whose eight corners are not of one phase, for all x of the row y, z. */
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

/* Sets bit BLOCK * r + x of blocks[b], initially 0, to bit BLOCK * b + x of rows[r][word]. */
TARGETS static void gather_blocks(const uint64_t *rows, size_t words, size_t word,
                                  uint64_t blocks[PHASE_WORD / BLOCK]) {
  for (unsigned r = 0; r < BLOCK * BLOCK; r++) {
    const uint64_t row = rows[r * words + word];
    for (unsigned b = 0; b < PHASE_WORD / BLOCK; b++)
      blocks[b] |= (row >> BLOCK * b & 15u) << BLOCK * r;
  }
}

/* Finds the crossed cells of one row of blocks, and their number in each block. */
static void find_row(const uint64_t *bits, struct surfels *surfels, uint64_t *crossed, size_t row,
                     struct scratch *scratch) {
  const size_t *size = surfels->size, *blocks = surfels->blocks, words = phase_words(size[0]);
  const size_t by = row % blocks[1], bz = row / blocks[1], each = PHASE_WORD / BLOCK;
  memset(scratch->crossed, 0, BLOCK * BLOCK * words * sizeof *scratch->crossed);
  for (size_t r = 0; r < BLOCK * BLOCK; r++) {
    const size_t y = by * BLOCK + r % BLOCK, z = bz * BLOCK + r / BLOCK;
    if (y < size[1] && z + 1 < size[2])
      row_crossings(bits, size, y, z, scratch, scratch->crossed + r * words);
  }
  for (size_t w = 0; w < words; w++) {
    uint64_t some[PHASE_WORD / BLOCK] = {0};
    gather_blocks(scratch->crossed, words, w, some);
    for (size_t b = 0; b < each && w * each + b < blocks[0]; b++) {
      const size_t at = w * each + b, block = row * blocks[0] + at;
      crossed[block] = some[b];
      surfels->first[block + 1] = (uint32_t)__builtin_popcountll(some[b]);
      surfels->occupied[row * surfels->words + at / PHASE_WORD] |= (uint64_t)(some[b] != 0)
                                                                   << at % PHASE_WORD;
    }
  }
}

static uint32_t two_greys(const int16_t *at) {
  uint32_t pair;
  memcpy(&pair, at, sizeof pair);
  return pair;
}

/* Position of a cell of a block: in the block, as an offset in the field, and encoded as the place
 * of a disc. */
struct cell_place {
  size_t x, y, z, offset;
  uint32_t first;
};

static void fill_block(const int16_t *field, struct surfels *surfels, uint64_t crossed,
                       const size_t at[3], const struct cell_place places[BITS],
                       struct cells *cells) {
  const size_t *size = surfels->size, nx = size[0], plane = nx * size[1];
  const int16_t *corner = field + at[2] * BLOCK * plane + at[1] * BLOCK * nx + at[0] * BLOCK;
  const bool inside = (at[0] + 1) * BLOCK < nx && (at[1] + 1) * BLOCK < size[1];
  for (uint64_t open = crossed; open != 0; open &= open - 1) {
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
      const size_t right = x + 1 < nx ? 1 : 0; /* else the neighbour is the first of the row */
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

/* The bounding box of the n discs of a block. Along an axis a disc extends by its radius times the
 * sine of the angle between its normal and that axis. */
TARGETS static void find_box(const uint32_t *restrict places, const uint32_t *restrict normals,
                             size_t n, const double stretch[3], struct surfel_box *box) {
  for (int d = 0; d < 3; d++) {
    const float radius = (float)(SURFELS_RADIUS / stretch[d]);
    float low = BLOCK + 1.0f, high = -1.0f;
    for (size_t i = 0; i < n; i++) {
      const uint32_t place = places[i], normal = normals[i];
      const float x = (float)((int)(normal << 24) >> 24), y = (float)((int)(normal << 16) >> 24),
                  z = (float)((int)(normal << 8) >> 24),
                  along = d == 0   ? x
                          : d == 1 ? y
                                   : z;
      const float square = x * x + y * y + z * z, one = square > 0.0f ? square : 1.0f;
      const float across = 1.0f - along * along / one;
      const float reach = radius * sqrtf(across > 0.0f ? across : 0.0f);
      const float at = (float)(int)(place >> 10 * d & 1023u) * (1.0f / 255.0f);
      low = at - reach < low ? at - reach : low;
      high = at + reach > high ? at + reach : high;
    }
    box->low[d] = (uint8_t)floorf((low + 1.0f) * SURFELS_PARTS);
    box->high[d] = (uint8_t)ceilf((high + 1.0f) * SURFELS_PARTS);
  }
}

static void fill_row(const int16_t *field, struct surfels *surfels, const uint64_t *crossed,
                     size_t row, struct cells *cells) {
  struct cell_place places[BITS];
  const size_t *blocks = surfels->blocks;
  for (size_t i = 0; i < BITS; i++) {
    struct cell_place *place = &places[i];
    *place = (struct cell_place){.x = i % BLOCK, .y = i / BLOCK % BLOCK, .z = i / BLOCK / BLOCK};
    place->offset = (place->z * surfels->size[1] + place->y) * surfels->size[0] + place->x;
    place->first = (uint32_t)(255 * (place->x | place->y << 10 | place->z << 20));
  }
  cells->n = 0;
  cells->item = surfels->first[row * blocks[0]];
  for (size_t bx = 0; bx < blocks[0]; bx++)
    fill_block(field, surfels, crossed[row * blocks[0] + bx],
               (size_t[3]){bx, row % blocks[1], row / blocks[1]}, places, cells);
  if (cells->n > 0) flush_cells(cells, surfels);
  for (size_t block = row * blocks[0]; block < (row + 1) * blocks[0]; block++) {
    const uint32_t first = surfels->first[block], end = surfels->first[block + 1];
    if (end > first)
      find_box(surfels->items + first, surfels->items + surfels->count + first, end - first,
               surfels->stretch, &surfels->boxes[block]);
  }
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
  uint64_t *crossed = NULL; /* bits of the cells of each block that contain a disc */
  const size_t threads = (size_t)omp_get_max_threads();
  memset(surfels, 0, sizeof *surfels);
  memcpy(surfels->size, size, sizeof surfels->size);
  memcpy(surfels->stretch, stretch, sizeof surfels->stretch);
  for (int d = 0; d < 3; d++) surfels->blocks[d] = (size[d] + BLOCK - 1) / BLOCK;
  const size_t rows = surfels->blocks[1] * surfels->blocks[2], blocks = rows * surfels->blocks[0];
  const size_t words = rows * (surfels->words = phase_words(surfels->blocks[0]));
  TRY(memory_allocate(&crossed, blocks, sizeof *crossed, "surface blocks"));
  TRY(memory_allocate(&surfels->first, blocks + 1, sizeof *surfels->first, "surface blocks"));
  TRY(memory_allocate(&surfels->occupied, words, sizeof *surfels->occupied, "surface blocks"));
  TRY(scratch_start(phase_words(size[0]), threads, &scratch));
#pragma omp parallel for schedule(dynamic)
  for (size_t row = 0; row < rows; row++)
    find_row(bits, surfels, crossed, row, scratch + omp_get_thread_num());
  uint64_t total = 0;
  for (size_t b = 0; b <= blocks; b++) {
    total += surfels->first[b];
    if (total > UINT32_MAX) TRY_FAIL(STATUS_RUN, "the grain surface has too many facets");
    surfels->first[b] = (uint32_t)total;
  }
  surfels->count = (size_t)total;
  if (total == 0) goto cleanup;
  TRY(memory_allocate(&surfels->boxes, blocks, sizeof *surfels->boxes, "surface blocks"));
  TRY(memory_allocate(&surfels->items, 2 * surfels->count, sizeof *surfels->items,
                      "the grain surface"));
#pragma omp parallel for schedule(dynamic)
  for (size_t row = 0; row < rows; row++)
    fill_row(field, surfels, crossed, row, &scratch[omp_get_thread_num()].cells);
cleanup:
  memory_free(&crossed);
  scratch_end(threads, &scratch);
  if (status != STATUS_OK) surfels_end(surfels);
  return status;
}

void surfels_end(struct surfels *surfels) {
  MEMORY_FREE(&surfels->boxes, &surfels->first, &surfels->items, &surfels->occupied);
  surfels->count = 0;
}
