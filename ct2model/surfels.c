#include "ct2model/surfels.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"

enum { BLOCK = 4 };
static const double DISC_RADIUS = 0.71; /* half the diagonal of a cell's face */

/* A disc is two words: its place in the block, three times ten bits, to 1/255 of a cell, and its
 * normal, three times eight bits, to 1/127: errors under 0.006 voxels. */
enum { LANES = 16 };

/* Cells that the surface crosses, many at a time: corner c of a cell is (c & 1, c >> 1 & 1, c >>
 * 2). */
enum { CELLS = 64 };
struct cells {
  size_t n;
  uint32_t item[CELLS];    /* where in the list it goes */
  int32_t first[3][CELLS]; /* of the cell, in its block */
  float corner[8][CELLS];
  uint32_t place[CELLS], normal[CELLS];
};

/* Where an edge from grey a to grey b crosses zero; 0 where it does not. */
#define CROSSED(a, b) (((a) > 0.0f) != ((b) > 0.0f) ? 1.0f : 0.0f)
#define CROSSING(a, b) (((a) > 0.0f) != ((b) > 0.0f) ? (a) / ((a) - (b)) : 0.0f)
#define BILINEAR(u, v, a, b, c, d)                                                                 \
  ((1.0f - (v)) * ((1.0f - (u)) * (a) + (u) * (b)) + (v) * ((1.0f - (u)) * (c) + (u) * (d)))
#define ROUNDED(value) ((int)((value) + 128.5f) - 128)

TARGETS static void make_surfels(struct cells *cells, const float stretch[3]) {
  const float sx = 1.0f / stretch[0], sy = 1.0f / stretch[1], sz = 1.0f / stretch[2];
  for (size_t i = 0; i < CELLS; i++) {
    const float a = cells->corner[0][i], b = cells->corner[1][i], c = cells->corner[2][i],
                d = cells->corner[3][i], e = cells->corner[4][i], f = cells->corner[5][i],
                g = cells->corner[6][i], h = cells->corner[7][i];
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
    const int px = 255 * cells->first[0][i] + (int)(255.0f * x + 0.5f);
    const int py = 255 * cells->first[1][i] + (int)(255.0f * y + 0.5f);
    const int pz = 255 * cells->first[2][i] + (int)(255.0f * z + 0.5f);
    const int nx = ROUNDED(unit * dx), ny = ROUNDED(unit * dy), nz = ROUNDED(unit * dz);
    cells->place[i] = (uint32_t)(px | py << 10 | pz << 20);
    cells->normal[i] = (uint32_t)((nx & 255) | (ny & 255) << 8 | (nz & 255) << 16);
  }
}

static void flush_cells(struct cells *cells, struct surfels *surfels) {
  const float stretch[3] = {(float)surfels->stretch[0], (float)surfels->stretch[1],
                            (float)surfels->stretch[2]};
  make_surfels(cells, stretch);
  for (size_t i = 0; i < cells->n; i++) {
    surfels->items[cells->item[i]] = cells->place[i];
    surfels->items[surfels->pitch + cells->item[i]] = cells->normal[i];
  }
  cells->n = 0;
}

/* crossed[x] for the cells of one row: 1 where the eight corners disagree. */
TARGETS static void row_crossings(const int16_t *restrict a, const int16_t *restrict b,
                                  const int16_t *restrict c, const int16_t *restrict d, size_t nx,
                                  uint8_t *restrict grains, uint8_t *restrict crossed) {
  for (size_t x = 0; x < nx; x++)
    grains[x] = (uint8_t)((a[x] > 0) + (b[x] > 0) + (c[x] > 0) + (d[x] > 0));
  grains[nx] = grains[0];
  for (size_t x = 0; x < nx; x++) {
    const uint8_t all = (uint8_t)(grains[x] + grains[x + 1]);
    crossed[x] = (uint8_t)((all != 0) & (all != 8));
  }
}

/* What a thread needs for a row. */
struct row {
  uint8_t *grains, *crossed; /* nx + 1 and nx + BLOCK */
  uint32_t *at;              /* the crossed cells' x */
  struct cells cells;
};

static void add_row(const int16_t *const rows[4], size_t y, size_t z, size_t block_row,
                    uint32_t *cursor, struct row *row, struct surfels *surfels) {
  const size_t nx = surfels->size[0];
  struct cells *cells = &row->cells;
  size_t count = 0;
  for (size_t x = 0; x < nx; x++) {
    row->at[count] = (uint32_t)x;
    count += row->crossed[x];
  }
  for (size_t k = 0; k < count; k++) {
    const size_t x = row->at[k], i = cells->n++, next = x + 1 < nx ? x + 1 : 0;
    cells->item[i] = cursor[block_row + x / BLOCK]++; // NOLINT: given once there are items
    cells->first[0][i] = (int32_t)(x % BLOCK);
    cells->first[1][i] = (int32_t)(y % BLOCK);
    cells->first[2][i] = (int32_t)(z % BLOCK);
    for (size_t c = 0; c < 4; c++) {
      cells->corner[2 * c][i] = rows[c][x];
      cells->corner[2 * c + 1][i] = rows[c][next];
    }
    if (cells->n == CELLS) flush_cells(cells, surfels);
  }
}

/* All cells of one layer of blocks: counted into first[block + 1], or made if `items`. */
static void block_layer(const int16_t *field, struct surfels *surfels, size_t bz, struct row *row,
                        uint32_t *cursor) {
  const size_t *size = surfels->size, nx = size[0], plane = nx * size[1];
  for (size_t z = bz * BLOCK; z < (bz + 1) * BLOCK && z + 1 < size[2]; z++) {
    for (size_t y = 0; y < size[1]; y++) {
      const int16_t *at = field + z * plane + y * nx,
                    *next = field + z * plane + (y + 1) % size[1] * nx;
      const int16_t *const rows[4] = {at, next, at + plane, next + plane};
      const size_t block_row = (bz * surfels->blocks[1] + y / BLOCK) * surfels->blocks[0];
      row_crossings(rows[0], rows[1], rows[2], rows[3], nx, row->grains, row->crossed);
      if (surfels->items != NULL) {
        add_row(rows, y, z, block_row, cursor, row, surfels);
        continue;
      }
      uint32_t *count = surfels->first + block_row + 1;
      for (size_t b = 0; b < surfels->blocks[0]; b++)
        for (size_t k = 0; k < BLOCK; k++) count[b] += row->crossed[b * BLOCK + k];
    }
  }
  if (surfels->items != NULL && row->cells.n > 0) flush_cells(&row->cells, surfels);
}

static enum status rows_start(size_t nx, size_t threads, struct row **rows) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(rows, threads, sizeof **rows, "surface rows"));
  for (size_t i = 0; i < threads; i++) {
    TRY(memory_allocate(&(*rows)[i].grains, nx + 1, 1, "surface rows"));
    TRY(memory_allocate(&(*rows)[i].crossed, nx + BLOCK, 1, "surface rows"));
    TRY(memory_allocate(&(*rows)[i].at, nx + 1, sizeof(uint32_t), "surface rows"));
  }
cleanup:
  return status;
}

static void rows_end(size_t threads, struct row **rows) {
  for (size_t i = 0; i < threads && *rows != NULL; i++) {
    memory_free(&(*rows)[i].grains);
    memory_free(&(*rows)[i].crossed);
    memory_free(&(*rows)[i].at);
  }
  memory_free(rows);
}

/* Chessboard distance to the nearest block with items, by two passes over 13 neighbours each. */
static void measure_away(struct surfels *surfels) {
  const long nx = (long)surfels->blocks[0], ny = (long)surfels->blocks[1],
             nz = (long)surfels->blocks[2];
  const long count = nx * ny * nz;
  for (long b = 0; b < count; b++)
    surfels->away[b] = surfels->first[b + 1] > surfels->first[b] ? 0 : 255;
  for (int pass = 0; pass < 2; pass++) {
    for (long i = 0; i < count; i++) {
      long b = pass == 0 ? i : count - 1 - i, sign = pass == 0 ? -1 : 1;
      long x = b % nx, y = b / nx % ny, z = b / nx / ny;
      for (int n = 0; n < 13 && surfels->away[b] > 0; n++) { /* the 13 neighbours met before */
        long dx = sign * (n < 9 ? n % 3 - 1 : n < 12 ? n - 10 : 1);
        long dy = sign * (n < 9 ? n / 3 - 1 : n < 12 ? 1 : 0), dz = n < 9 ? sign : 0;
        if (x + dx < 0 || x + dx >= nx || y + dy < 0 || y + dy >= ny || z + dz < 0 || z + dz >= nz)
          continue;
        uint8_t there = surfels->away[b + dx + nx * (dy + ny * dz)];
        if (there < 254 && there + 1 < surfels->away[b]) surfels->away[b] = (uint8_t)(there + 1);
      }
    }
  }
}

enum status surfels_build(const int16_t *field, const size_t size[3], const double stretch[3],
                          struct surfels *surfels) {
  enum status status = STATUS_OK;
  uint32_t *cursor = NULL;
  struct row *rows = NULL;
  const size_t threads = (size_t)omp_get_max_threads();
  memset(surfels, 0, sizeof *surfels);
  memcpy(surfels->size, size, sizeof surfels->size);
  memcpy(surfels->stretch, stretch, sizeof surfels->stretch);
  for (int d = 0; d < 3; d++) surfels->blocks[d] = (size[d] + BLOCK - 1) / BLOCK;
  size_t blocks = surfels->blocks[0] * surfels->blocks[1] * surfels->blocks[2];
  size_t layers = surfels->blocks[2];
  TRY(memory_allocate(&surfels->first, blocks + 1, sizeof *surfels->first, "surface blocks"));
  TRY(rows_start(size[0], threads, &rows));
#pragma omp parallel for schedule(dynamic)
  for (size_t bz = 0; bz < layers; bz++)
    block_layer(field, surfels, bz, rows + omp_get_thread_num(), NULL);
  uint64_t total = 0;
  for (size_t b = 0; b <= blocks; b++) {
    total += surfels->first[b];
    if (total > UINT32_MAX) TRY_FAIL(STATUS_RUN, "the grain surface has too many facets");
    surfels->first[b] = (uint32_t)total;
  }
  surfels->count = (size_t)total;
  if (total == 0) goto cleanup;
  TRY(memory_allocate(&cursor, blocks, sizeof *cursor, "surface blocks"));
  memcpy(cursor, surfels->first, blocks * sizeof *cursor);
  surfels->pitch = surfels->count + LANES; /* whole vectors are read */
  TRY(memory_allocate(&surfels->items, 2 * surfels->pitch, sizeof *surfels->items,
                      "the grain surface"));
#pragma omp parallel for schedule(dynamic)
  for (size_t bz = 0; bz < layers; bz++)
    block_layer(field, surfels, bz, rows + omp_get_thread_num(), cursor);
  TRY(memory_allocate(&surfels->away, blocks, 1, "surface blocks"));
  measure_away(surfels);
cleanup:
  memory_free(&cursor);
  rows_end(threads, &rows);
  if (status != STATUS_OK) surfels_end(surfels);
  return status;
}

void surfels_end(struct surfels *surfels) {
  memory_free(&surfels->first);
  memory_free(&surfels->items);
  memory_free(&surfels->away);
  surfels->count = 0;
}

/* Squared distance to the nearest of n discs; `point` from the first cell's first corner. */
TARGETS static float nearest_disc(const uint32_t *restrict places, const uint32_t *restrict normals,
                                  int n, const float point[3], const float stretch[3]) {
  const float x0 = point[0], y0 = point[1], z0 = point[2], radius = (float)DISC_RADIUS;
  const float sx = stretch[0] / 255.0f, sy = stretch[1] / 255.0f, sz = stretch[2] / 255.0f;
  float best[LANES];
  for (int l = 0; l < LANES; l++) best[l] = INFINITY;
  for (int i = 0; i < n; i += LANES) {
    for (int l = 0; l < LANES; l++) {
      const uint32_t place = places[i + l], normal = normals[i + l];
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
      const float square = height * height + beyond * beyond;
      const float here = i + l < n ? square : INFINITY;
      best[l] = here < best[l] ? here : best[l];
    }
  }
  for (int half = LANES / 2; half > 0; half /= 2)
    for (int l = 0; l < half; l++) best[l] = best[l + half] < best[l] ? best[l + half] : best[l];
  return best[0];
}

/* The nearest disc of one block, if nearer than `best`. */
static double block_distance(const struct surfels *surfels, const size_t block[3],
                             const double point[3], double best) {
  size_t index = (block[2] * surfels->blocks[1] + block[1]) * surfels->blocks[0] + block[0];
  const uint32_t first = surfels->first[index], end = surfels->first[index + 1];
  float local[3], stretch[3];
  if (first == end) return best;
  for (int d = 0; d < 3; d++) {
    stretch[d] = (float)surfels->stretch[d];
    local[d] = (float)(point[d] - ((double)(block[d] * BLOCK) + 0.5) * surfels->stretch[d]);
  }
  const float square = nearest_disc(surfels->items + first, surfels->items + surfels->pitch + first,
                                    (int)(end - first), local, stretch);
  return (double)square < best * best ? sqrt((double)square) : best;
}

/* Distance from a coordinate to block b's cells along one axis. */
static double axis_gap(double at, long b, double stretch) {
  double low = ((double)b * BLOCK + 0.5) * stretch, high = low + BLOCK * stretch;
  return at < low ? low - at : at > high ? at - high : 0.0;
}

/* Shells about `home` that hold nothing for certain; 255: all of them. */
static long empty_shells(const struct surfels *surfels, const long home[3]) {
  for (int d = 0; d < 3; d++)
    if (home[d] < 0 || home[d] >= (long)surfels->blocks[d]) return 0;
  return surfels
      ->away[(home[2] * (long)surfels->blocks[1] + home[1]) * (long)surfels->blocks[0] + home[0]];
}

/* Shells of blocks around the point, until the next shell must be farther than the best. */
static double search(const struct surfels *surfels, const double point[3], double best) {
  long home[3], reach = 0;
  double edge = INFINITY; /* from the point to the edge of its own block */
  for (int d = 0; d < 3; d++) {
    double at = point[d] / surfels->stretch[d] - 0.5;
    home[d] = (long)floor(at / BLOCK);
    double inside = at - (double)home[d] * BLOCK;
    edge = fmin(edge, fmin(inside, BLOCK - inside) * surfels->stretch[d]);
    reach = (long)fmax((double)reach,
                       fmax((double)home[d], (double)surfels->blocks[d] - 1.0 - (double)home[d]));
  }
  double step = BLOCK * fmin(surfels->stretch[0], fmin(surfels->stretch[1], surfels->stretch[2]));
  for (long r = empty_shells(surfels, home); r <= reach; r++) {
    if (r > 0 && edge + (double)(r - 1) * step > best + DISC_RADIUS) break;
    for (long z = home[2] - r; z <= home[2] + r; z++) {
      if (z < 0 || z >= (long)surfels->blocks[2]) continue;
      double gz = axis_gap(point[2], z, surfels->stretch[2]);
      if (gz > best + DISC_RADIUS) continue;
      for (long y = home[1] - r; y <= home[1] + r; y++) {
        if (y < 0 || y >= (long)surfels->blocks[1]) continue;
        double gy = axis_gap(point[1], y, surfels->stretch[1]);
        bool face = labs(z - home[2]) == r || labs(y - home[1]) == r;
        long hop = face || r == 0 ? 1 : 2 * r;
        for (long x = home[0] - r; x <= home[0] + r; x += hop) {
          if (x < 0 || x >= (long)surfels->blocks[0]) continue;
          double gx = axis_gap(point[0], x, surfels->stretch[0]);
          double bound = best + DISC_RADIUS;
          if (gx * gx + gy * gy + gz * gz > bound * bound) continue;
          best = block_distance(surfels, (size_t[3]){(size_t)x, (size_t)y, (size_t)z}, point, best);
        }
      }
    }
  }
  return best;
}

double surfels_distance(const struct surfels *surfels, const double point[3], double limit) {
  if (surfels->count == 0) return limit;
  double best = search(surfels, point, limit);
  double period[2] = {(double)surfels->size[0] * surfels->stretch[0],
                      (double)surfels->size[1] * surfels->stretch[1]};
  for (int iy = -1; iy <= 1; iy++) {
    for (int ix = -1; ix <= 1; ix++) {
      if (ix == 0 && iy == 0) continue;
      double image[3] = {point[0] + ix * period[0], point[1] + iy * period[1], point[2]};
      /* Cells lie between 1/2 and size + 1/2. */
      double gap = 0.0;
      for (int d = 0; d < 2; d++) {
        double low = 0.5 * surfels->stretch[d], high = low + period[d];
        double out = fmax(0.0, fmax(low - image[d], image[d] - high));
        gap += out * out;
      }
      if (gap < (best + DISC_RADIUS) * (best + DISC_RADIUS)) best = search(surfels, image, best);
    }
  }
  return best;
}
