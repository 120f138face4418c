#include "ct2model/surfels.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"

enum { BLOCK = 4 };
static const double DISC_RADIUS = 0.71; /* half the diagonal of a cell's face */

/* Positions to 1/255 and normals to 1/127 of a cell: errors under 0.006 voxels. */
struct surfel {
  uint8_t cell; /* x + 4 y + 16 z in its block */
  uint8_t position[3];
  int8_t normal[3];
};

/* Eight corners, corner c at (c & 1, c >> 1 & 1, c >> 2). */
static void cell_corners(const int16_t *field, const size_t size[3], const size_t cell[3],
                         float corner[8]) {
  size_t x[2] = {cell[0], cell[0] + 1 < size[0] ? cell[0] + 1 : 0};
  size_t y[2] = {cell[1], cell[1] + 1 < size[1] ? cell[1] + 1 : 0};
  for (unsigned c = 0; c < 8; c++)
    corner[c] = field[((cell[2] + (c >> 2)) * size[1] + y[c >> 1 & 1]) * size[0] + x[c & 1]];
}

/* Without branches, which no processor could foretell here. */
static struct surfel make_surfel(const float corner[8], const float stretch[3]) {
  /* The four edges along x, then y, then z: from corner A to corner B. */
  static const uint8_t A[12] = {0, 2, 4, 6, 0, 1, 4, 5, 0, 1, 2, 3};
  static const uint8_t B[12] = {1, 3, 5, 7, 2, 3, 6, 7, 4, 5, 6, 7};
  /* What corner A of each edge adds to the two other coordinates. */
  static const float OTHER[3][12] = {{0, 0, 0, 0, 0, 1, 0, 1, 0, 1, 0, 1},
                                     {0, 1, 0, 1, 0, 0, 0, 0, 0, 0, 1, 1},
                                     {0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 0, 0}};
  float crossed[12], at[12], rise[12], centre[3] = {0, 0, 0}, gradient[3], count = 0.0f;
  for (int e = 0; e < 12; e++) {
    float a = corner[A[e]], b = corner[B[e]];
    rise[e] = b - a;
    bool cuts = (a > 0.0f) != (b > 0.0f);
    crossed[e] = cuts ? 1.0f : 0.0f;
    at[e] = crossed[e] * a / (cuts ? a - b : 1.0f);
  }
  for (int e = 0; e < 12; e++) {
    count += crossed[e];
    for (int d = 0; d < 3; d++) centre[d] += crossed[e] * OTHER[d][e];
  }
  for (int e = 0; e < 4; e++)
    for (int d = 0; d < 3; d++) centre[d] += at[4 * d + e];
  for (int d = 0; d < 3; d++) centre[d] /= count;
  float length = 0.0f;
  for (int d = 0; d < 3; d++) { /* along the axis, bilinear between its four edges */
    float u = centre[d == 0 ? 1 : 0], v = centre[d == 2 ? 1 : 2];
    const float *r = rise + 4 * d;
    gradient[d] =
        ((1.0f - v) * ((1.0f - u) * r[0] + u * r[1]) + v * ((1.0f - u) * r[2] + u * r[3])) /
        stretch[d];
    length += gradient[d] * gradient[d];
  }
  length = length > 0.0f ? sqrtf(length) : 1.0f;
  struct surfel surfel = {0};
  for (int d = 0; d < 3; d++) {
    float normal = 127.0f * gradient[d] / length;
    surfel.position[d] = (uint8_t)(255.0f * centre[d] + 0.5f);
    surfel.normal[d] = (int8_t)(normal < 0.0f ? normal - 0.5f : normal + 0.5f);
  }
  return surfel;
}

/* crossed[x] for the cells of one row: true where the eight corners disagree. */
static void row_crossings(const int16_t *field, const size_t size[3], size_t y, size_t z,
                          uint8_t *grains, uint8_t *crossed) {
  size_t nx = size[0], y1 = (y + 1) % size[1];
  const int16_t *a = field + (z * size[1] + y) * nx, *b = field + (z * size[1] + y1) * nx;
  const int16_t *c = a + size[1] * nx, *d = b + size[1] * nx;
  for (size_t x = 0; x < nx; x++)
    grains[x] = (uint8_t)((a[x] > 0) + (b[x] > 0) + (c[x] > 0) + (d[x] > 0));
  grains[nx] = grains[0];
  for (size_t x = 0; x < nx; x++) crossed[x] = (uint8_t)(grains[x] + grains[x + 1]) % 8 != 0;
}

/* All cells of one layer of blocks: counted into first[block + 1], or made if `items`. */
static void block_layer(const int16_t *field, struct surfels *surfels, size_t bz, uint8_t *row,
                        uint32_t *cursor) {
  const size_t *size = surfels->size;
  const float stretch[3] = {(float)surfels->stretch[0], (float)surfels->stretch[1],
                            (float)surfels->stretch[2]};
  uint8_t *crossed = row + size[0] + 1;
  for (size_t z = bz * BLOCK; z < (bz + 1) * BLOCK && z + 1 < size[2]; z++) {
    for (size_t y = 0; y < size[1]; y++) {
      size_t block_row = (bz * surfels->blocks[1] + y / BLOCK) * surfels->blocks[0];
      row_crossings(field, size, y, z, row, crossed);
      for (size_t x = 0; x < size[0]; x++) {
        if (!crossed[x]) continue;
        size_t block = block_row + x / BLOCK;
        if (surfels->items == NULL) {
          surfels->first[block + 1]++;
          continue;
        }
        float corner[8];
        cell_corners(field, size, (size_t[3]){x, y, z}, corner);
        struct surfel surfel = make_surfel(corner, stretch);
        surfel.cell = (uint8_t)(x % BLOCK + BLOCK * (y % BLOCK) + BLOCK * BLOCK * (z % BLOCK));
        surfels->items[cursor[block]++] = surfel;
      }
    }
  }
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
  uint8_t *rows = NULL;
  memset(surfels, 0, sizeof *surfels);
  memcpy(surfels->size, size, sizeof surfels->size);
  memcpy(surfels->stretch, stretch, sizeof surfels->stretch);
  for (int d = 0; d < 3; d++) surfels->blocks[d] = (size[d] + BLOCK - 1) / BLOCK;
  size_t blocks = surfels->blocks[0] * surfels->blocks[1] * surfels->blocks[2];
  size_t row = 2 * size[0] + 1, layers = surfels->blocks[2];
  TRY(memory_allocate(&surfels->first, blocks + 1, sizeof *surfels->first, "surface blocks"));
  TRY(memory_allocate(&rows, layers * row, 1, "surface rows"));
#pragma omp parallel for schedule(dynamic)
  for (size_t bz = 0; bz < layers; bz++) block_layer(field, surfels, bz, rows + bz * row, NULL);
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
  TRY(memory_allocate(&surfels->items, surfels->count, sizeof *surfels->items,
                      "the grain surface"));
#pragma omp parallel for schedule(dynamic)
  for (size_t bz = 0; bz < layers; bz++) block_layer(field, surfels, bz, rows + bz * row, cursor);
  TRY(memory_allocate(&surfels->away, blocks, 1, "surface blocks"));
  measure_away(surfels);
cleanup:
  memory_free(&cursor);
  memory_free(&rows);
  if (status != STATUS_OK) surfels_end(surfels);
  return status;
}

void surfels_end(struct surfels *surfels) {
  memory_free(&surfels->first);
  memory_free(&surfels->items);
  memory_free(&surfels->away);
  surfels->count = 0;
}

/* The nearest disc of one block, if nearer than `best`. */
static double block_distance(const struct surfels *surfels, const size_t block[3],
                             const double point[3], double best) {
  size_t index = (block[2] * surfels->blocks[1] + block[1]) * surfels->blocks[0] + block[0];
  for (uint32_t i = surfels->first[index]; i < surfels->first[index + 1]; i++) {
    const struct surfel *s = &surfels->items[i];
    double square = 0.0, height = 0.0;
    for (int d = 0; d < 3; d++) {
      double cell = (double)(block[d] * BLOCK + (s->cell >> 2 * d & 3u));
      double q = point[d] - (cell + 0.5 + s->position[d] * (1.0 / 255.0)) * surfels->stretch[d];
      square += q * q;
      height += q * s->normal[d] * (1.0 / 127.0);
    }
    if (square > (best + DISC_RADIUS) * (best + DISC_RADIUS)) continue;
    double aside = square - height * height, distance = fabs(height);
    if (aside > DISC_RADIUS * DISC_RADIUS) {
      double over = sqrt(aside) - DISC_RADIUS;
      distance = sqrt(height * height + over * over);
    }
    if (distance < best) best = distance;
  }
  return best;
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
