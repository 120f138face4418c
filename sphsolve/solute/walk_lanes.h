/* Sixteen walkers at a time: the same steps as in walk_move.h, without branches, so that the
 * compiler can vectorise the loops. The results are bitwise the same. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_LANES_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_LANES_H

#include <string.h>

#include "sphsolve/solute/walk_move.h"

#define LANES 16

/* struct walker as a structure of arrays. */
struct walk_lanes {
  float x[3][LANES];
  int32_t wrapped[3][LANES], cell[3][LANES], number[LANES];
  uint32_t address[LANES], walls[LANES], id[LANES];
} __attribute__((aligned(64)));

WALK_HOT void lanes_put(struct walk_lanes *g, int l, const struct walker *w) {
  for (int a = 0; a < 3; a++) {
    g->x[a][l] = w->x[a];
    g->wrapped[a][l] = w->wrapped[a], g->cell[a][l] = w->cell[a];
  }
  g->number[l] = w->number, g->address[l] = w->address, g->walls[l] = w->walls, g->id[l] = w->id;
}

WALK_HOT struct walker lanes_take(const struct walk_lanes *g, int l) {
  return (struct walker){.x = {g->x[0][l], g->x[1][l], g->x[2][l], 0},
                         .wrapped = {g->wrapped[0][l], g->wrapped[1][l], g->wrapped[2][l], 0},
                         .cell = {g->cell[0][l], g->cell[1][l], g->cell[2][l], 0},
                         .number = g->number[l],
                         .address = g->address[l],
                         .walls = g->walls[l],
                         .id = g->id[l]};
}

/* Transposes four words of the records of sixteen cells: word first + w of each cell into word[w].
 * Cells l, l + 4, l + 8, l + 12 make a row, and each quarter of the four rows is transposed
 * separately. */
WALK_HOT void lanes_columns(const struct walk_cells *c, const int32_t number[LANES], int first,
                            int32_t word[4][LANES]) {
  typedef int32_t quarter __attribute__((vector_size(16)));
  typedef int32_t half __attribute__((vector_size(32)));
  typedef int32_t row __attribute__((vector_size(64)));
  quarter r[LANES];
  row t[4];
#pragma GCC unroll 16
  for (int l = 0; l < LANES; l++)
    memcpy(&r[l], (const char *)&c->cell[number[l]] + sizeof(int32_t) * (size_t)first, sizeof r[l]);
#pragma GCC unroll 4
  for (int l = 0; l < 4; l++) {
    const half low = __builtin_shufflevector(r[l], r[l + 4], 0, 1, 2, 3, 4, 5, 6, 7),
               high = __builtin_shufflevector(r[l + 8], r[l + 12], 0, 1, 2, 3, 4, 5, 6, 7);
    t[l] = __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  }
  /* Two perfect shuffles within each quarter. */
#pragma GCC unroll 2
  for (int stage = 0; stage < 2; stage++) {
    const row a = t[0], b = t[1], d = t[2], e = t[3];
    t[0] = __builtin_shufflevector(a, d, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    t[1] =
        __builtin_shufflevector(a, d, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
    t[2] = __builtin_shufflevector(b, e, 0, 16, 1, 17, 4, 20, 5, 21, 8, 24, 9, 25, 12, 28, 13, 29);
    t[3] =
        __builtin_shufflevector(b, e, 2, 18, 3, 19, 6, 22, 7, 23, 10, 26, 11, 27, 14, 30, 15, 31);
  }
#pragma GCC unroll 4
  for (int w = 0; w < 4; w++) memcpy(word[w], &t[w], sizeof t[w]);
}

/* walk_velocity at x in the cells, for all lanes. */
WALK_HOT void lanes_velocity(const struct walk_cells *c, const int32_t number[LANES],
                             float x[3][LANES], float u[3][LANES]) {
  int32_t word[12][LANES] __attribute__((aligned(64)));
#pragma GCC unroll 3
  for (int q = 0; q < 3; q++) lanes_columns(c, number, 4 + 4 * q, &word[4 * q]);
  const float unit = c->slope_unit;
  for (int l = 0; l < LANES; l++) {
    float slope[4][3], face[2][3], low[3], high[3], scaled[3];
#pragma GCC unroll 12
    for (int k = 0; k < 12; k++)
      slope[k / 3][k % 3] =
          (float)(k % 2 ? word[k / 2][l] >> 16 : (int32_t)((uint32_t)word[k / 2][l] << 16) >> 16);
#pragma GCC unroll 6
    for (int k = 0; k < 6; k++) memcpy(&face[k / 3][k % 3], &word[6 + k][l], sizeof(float));
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++) scaled[a] = unit * x[a][l];
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++) {
      const float next = scaled[(a + 1) % 3], last = scaled[(a + 2) % 3];
      low[a] = face[0][a] + (slope[0][a] * next + slope[1][a] * last);
      high[a] = face[1][a] + (slope[2][a] * next + slope[3][a] * last);
    }
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++) {
      const int b = (a + 1) % 3, d = (a + 2) % 3;
      const float square = (slope[3][b] - slope[1][b]) + (slope[2][d] - slope[0][d]);
      u[a][l] = 0.5f * (low[a] + high[a]) + (high[a] - low[a]) * x[a][l] +
                square * (0.5f * unit) * (0.25f - x[a][l] * x[a][l]);
    }
  }
}

/* Walkers located in grain, one bit each: the opposite of walk_in_pore; also set where there is no
 * cell. */
WALK_HOT uint32_t lanes_in_grain(const struct walk_cells *c, const struct walk_lanes *g) {
  int32_t word[4][LANES] __attribute__((aligned(64)));
  int32_t number[LANES], grain[LANES];
  uint32_t cut = 0, mask = 0;
  for (int l = 0; l < LANES; l++) {
    cut |= g->walls[l];
    number[l] = g->number[l] < 0 ? 0 : g->number[l];
    grain[l] = g->number[l] < 0;
  }
  if (cut & WALK_CUT) {
    lanes_columns(c, number, 0, word);
    for (int l = 0; l < LANES; l++) {
      float edge[4];
#pragma GCC unroll 4
      for (int e = 0; e < 4; e++) {
        const int32_t low = word[e / 2][l], high = word[2 + e / 2][l];
        const float from = (float)(e % 2 ? low >> 16 : (int32_t)((uint32_t)low << 16) >> 16);
        const float to = (float)(e % 2 ? high >> 16 : (int32_t)((uint32_t)high << 16) >> 16);
        const float x = g->x[0][l] + 0.5f, y = g->x[1][l] + 0.5f, z = g->x[2][l] + 0.5f;
        edge[e] = (e % 2 ? x : 1 - x) * (e / 2 ? y : 1 - y) * (from + z * (to - from));
      }
      const float distance = c->distance_unit * ((edge[0] + edge[1]) + (edge[2] + edge[3]));
      grain[l] |= (g->walls[l] & WALK_CUT) != 0 && !(distance > 0);
    }
  }
  for (int l = 0; l < LANES; l++) mask |= (uint32_t)grain[l] << l;
  return mask;
}

/* walk_settle after a move; prefetches the new cells for the next step. Only walkers that left
 * their cell are looked up. */
WALK_HOT void lanes_settle(const struct walk_cells *c, struct walk_lanes *g) {
  int32_t left[LANES] = {0};
  uint32_t address[LANES], mask = 0;
  for (int a = 0; a < 3; a++) {
    const int32_t n = c->n[a];
    for (int l = 0; l < LANES; l++) {
      const float up = g->x[a][l] + 0.5f;
      int32_t step = (int32_t)up, at = g->wrapped[a][l];
      step -= up < (float)step;
      at += step;
      for (int turn = 0; turn < 2; turn++) {
        at += at < 0 ? n : 0;
        at -= at >= n ? n : 0;
      }
      g->x[a][l] -= (float)step;
      g->cell[a][l] += step;
      g->wrapped[a][l] = at;
      left[l] |= step;
    }
  }
  const int32_t row = c->blocks[0] << 12, layer = c->blocks[0] * c->blocks[1] << 12;
  for (int l = 0; l < LANES; l++) {
    const int32_t x = g->wrapped[0][l], y = g->wrapped[1][l], z = g->wrapped[2][l];
    address[l] =
        (uint32_t)(((x >> 4) << 12) + (y >> 4) * row + (z >> 4) * layer + ((x & 12) << 4) +
                   ((y & 12) << 6) + ((z & 12) << 8) + (x & 3) + ((y & 3) << 2) + ((z & 3) << 4));
    mask |= (uint32_t)(left[l] != 0) << l;
  }
  memcpy(g->address, address, sizeof address);
  for (; mask != 0; mask &= mask - 1) {
    const int l = __builtin_ctz(mask);
    walk_look_up(c, address[l], &g->number[l], &g->walls[l]);
    __builtin_prefetch(&c->cell[g->number[l] < 0 ? 0 : g->number[l]]);
  }
}

#endif
