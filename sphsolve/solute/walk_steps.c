#include "sphsolve/solute/walk_steps.h"

#include <string.h>

#include "common/variants.h"
#include "sphsolve/solute/walk_move.h"
#include "sphsolve/solute/walk_random.h"

/* Sixteen walkers at a time: the same steps as in walk_move.h, without branches, so that the
 * compiler can vectorise the loops. The results are bitwise the same. */
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
 * Cells l and l + 4 make a row of eight, as wide as a register of AVX2 (wider ones the compiler
 * takes apart in memory there), and each half of four rows is transposed separately. */
WALK_HOT void lanes_columns(const struct walk_cells *c, const int32_t number[LANES], int first,
                            int32_t word[4][LANES]) {
  typedef int32_t half __attribute__((vector_size(16)));
  typedef int32_t row __attribute__((vector_size(32)));
#pragma GCC unroll 2
  for (int from = 0; from < LANES; from += 8) {
    half r[8];
    row t[4];
#pragma GCC unroll 8
    for (int l = 0; l < 8; l++)
      memcpy(&r[l], (const char *)&c->cell[number[from + l]] + sizeof(int32_t) * (size_t)first,
             sizeof r[l]);
#pragma GCC unroll 4
    for (int l = 0; l < 4; l++)
      t[l] = __builtin_shufflevector(r[l], r[l + 4], 0, 1, 2, 3, 4, 5, 6, 7);
      /* Two perfect shuffles within each half. */
#pragma GCC unroll 2
    for (int stage = 0; stage < 2; stage++) {
      const row a = t[0], b = t[1], d = t[2], e = t[3];
      t[0] = __builtin_shufflevector(a, d, 0, 8, 1, 9, 4, 12, 5, 13);
      t[1] = __builtin_shufflevector(a, d, 2, 10, 3, 11, 6, 14, 7, 15);
      t[2] = __builtin_shufflevector(b, e, 0, 8, 1, 9, 4, 12, 5, 13);
      t[3] = __builtin_shufflevector(b, e, 2, 10, 3, 11, 6, 14, 7, 15);
    }
#pragma GCC unroll 4
    for (int w = 0; w < 4; w++) memcpy(&word[w][from], &t[w], sizeof t[w]);
  }
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

#define GROUPS 8
#define BLOCK (GROUPS * LANES) /* walkers whose data fit into the level 1 cache */

enum { FLIGHTS, STARTS }; /* streams of random numbers, second word of the key */

void walk_draw(uint32_t id, uint32_t number, uint32_t seed, uint32_t words[4]) {
  words[0] = id, words[1] = number, words[2] = words[3] = 0;
  philox4x32(words, seed, STARTS);
}

/* Sine and cosine of pi t for |t| <= 1/2: Taylor series up to the 11th power, error 6e-8. */
static inline void half_turn(float t, float *sine, float *cosine) {
  const float x = (float)M_PI * t, y = x * x;
  *sine =
      x * (1 + y * (-1.f / 6 + y * (1.f / 120 + y * (-1.f / 5040 +
                                                     y * (1.f / 362880 - y * (1.f / 39916800))))));
  *cosine = 1 + y * (-1.f / 2 +
                     y * (1.f / 24 + y * (-1.f / 720 + y * (1.f / 40320 - y * (1.f / 3628800)))));
}

/* Displacements of flights in uniformly distributed directions: the height is uniform between -1
 * and 1 (Archimedes), and so is the angle over a turn. For two steps of each walker. */
WALK_HOT void draw_flights(const struct walk_cells *c, const struct walk_step *step,
                           const uint32_t id[LANES], uint64_t number, float move[2][3][LANES]) {
  uint32_t words[4][LANES];
  for (int l = 0; l < LANES; l++) {
    uint32_t draw[4] = {id[l], (uint32_t)(number / 2), (uint32_t)(number / 2 >> 32), 0};
    philox4x32(draw, step->seed, FLIGHTS);
    for (int i = 0; i < 4; i++) words[i][l] = draw[i];
  }
  for (int s = 0; s < 2; s++)
    for (int l = 0; l < LANES; l++) {
      const float height = 2 * random_share(words[2 * s][l]) - 1;
      const float across = sqrtf(1 - height * height) * step->flight;
      float sine, cosine; /* of half the angle, and of the whole one from them */
      half_turn(random_share(words[2 * s + 1][l]) - 0.5f, &sine, &cosine);
      move[s][0][l] = across * (1 - 2 * sine * sine) * c->stretch[0];
      move[s][1][l] = across * (2 * sine * cosine) * c->stretch[1];
      move[s][2][l] = height * step->flight * c->stretch[2];
    }
}

/* State of sixteen walkers during a step. */
struct group {
  struct walk_lanes at, middle, end;
  int count;         /* walkers; lanes beyond repeat the last one, and are discarded */
  float part[LANES]; /* time of the first substep of advection */
  float move[2][3][LANES];
};

/* If walk_shift would end in grain: the walker stays in its cell, at the face. */
WALK_COLD void stay(struct walk_lanes *to, const struct walk_lanes *from, int l,
                    const float move[3]) {
  struct walker w = lanes_take(from, l);
  for (int a = 0; a < 3; a++) w.x[a] = walk_inside(w.x[a] + move[a]);
  lanes_put(to, l, &w);
}

/* Moves walkers from `from` by `move`. */
WALK_HOT void shift(const struct walk_cells *c, const struct walk_lanes *from, float move[3][LANES],
                    struct walk_lanes *to) {
  *to = *from;
  for (int a = 0; a < 3; a++)
    for (int l = 0; l < LANES; l++) to->x[a][l] += move[a][l];
  lanes_settle(c, to);
  int32_t grain = 0;
  for (int l = 0; l < LANES; l++) grain |= to->number[l];
  for (int l = 0; l < LANES && grain < 0; l++)
    if (to->number[l] < 0) stay(to, from, l, (float[3]){move[0][l], move[1][l], move[2][l]});
}

/* First half of the first substep of advection. */
WALK_HOT void advect_to_midpoint(const struct walk_cells *c, struct group *g, float time) {
  float u[3][LANES];
  lanes_velocity(c, g->at.number, g->at.x, u);
  for (int l = 0; l < LANES; l++) {
    g->part[l] = walk_substep(walk_largest(u[0][l], u[1][l], u[2][l]), time);
    for (int a = 0; a < 3; a++) u[a][l] *= 0.5f * g->part[l];
  }
  shift(c, &g->at, u, &g->middle);
}

/* Remaining substeps of advection of one walker; if it ends in grain, it continues until it returns
 * to the pore. False: it does not return. */
WALK_COLD bool finish_advection(const struct walk_cells *c, struct walk_lanes *at,
                                const struct walk_lanes *end, int l, float left, float time) {
  struct walker w = lanes_take(end, l);
  walk_advect(c, &w, left);
  if (!walk_in_pore(c, &w) && !walk_return(c, &w, time)) return false;
  lanes_put(at, l, &w);
  return true;
}

/* The whole first substep of advection, with the velocity at the midpoint. */
WALK_HOT void advect_first_substep(const struct walk_cells *c, struct group *g) {
  float u[3][LANES];
  lanes_velocity(c, g->middle.number, g->middle.x, u);
  for (int a = 0; a < 3; a++)
    for (int l = 0; l < LANES; l++) u[a][l] *= g->part[l];
  shift(c, &g->at, u, &g->end);
}

/* Completes the advection of all walkers. */
WALK_HOT void advect(const struct walk_cells *c, struct group *g, float time,
                     struct walk_rejected *rejected) {
  int rest[LANES], count = 0;
  const uint32_t grain = lanes_in_grain(c, &g->end);
  for (int l = 0; l < LANES; l++) {
    rest[count] = l;
    count += (g->part[l] < time) | (int)(grain >> l & 1);
  }
  const struct walk_lanes before = g->at;
  g->at = g->end;
  for (int i = 0; i < count; i++) {
    const int l = rest[i];
    if (finish_advection(c, &g->at, &g->end, l, time - g->part[l], time)) continue;
    const struct walker w = lanes_take(&before, l);
    lanes_put(&g->at, l, &w);
    rejected->advections += l < g->count;
  }
}

WALK_HOT void finish_flights(const struct walk_cells *c, struct group *g, int turn, float length,
                             struct walk_rejected *rejected) {
  int near[LANES], count = 0;
  const uint32_t grain = lanes_in_grain(c, &g->end);
  for (int l = 0; l < LANES; l++) {
    near[count] = l;
    count += (g->at.walls[l] & WALK_NEAR) != 0 && (grain >> l & 1);
  }
  const struct walk_lanes before = g->at;
  g->at = g->end;
  for (int i = 0; i < count; i++) {
    const int l = near[i];
    struct walker w = lanes_take(&before, l);
    const walk_vector move = {g->move[turn][0][l], g->move[turn][1][l], g->move[turn][2][l], 0};
    if (!walk_reflect(c, &w, move, length)) rejected->flights += l < g->count;
    lanes_put(&g->at, l, &w);
  }
}

/* Each phase of a step runs over all groups, so that the cells needed in the next phase are
 * prefetched in this one. */
TARGETS static void move_block(const struct walk_cells *c, const struct walk_step *step,
                               struct walker *walkers, int count, uint64_t first, int steps,
                               struct walk_rejected *rejected) {
  struct group group[GROUPS];
  const int groups = (count + LANES - 1) / LANES;
  for (int g = 0; g < groups; g++) group[g].count = count - g * LANES;
  for (int w = 0; w < groups * LANES; w++)
    lanes_put(&group[w / LANES].at, w % LANES, &walkers[w < count ? w : count - 1]);
  for (int s = 0; s < steps; s++) {
    for (int g = 0; g < groups; g++) {
      if (s % 2 == 0) draw_flights(c, step, group[g].at.id, first + (uint64_t)s, group[g].move);
      if (step->time > 0) advect_to_midpoint(c, &group[g], step->time);
    }
    for (int g = 0; g < groups && step->time > 0; g++) advect_first_substep(c, &group[g]);
    for (int g = 0; g < groups && step->time > 0; g++) advect(c, &group[g], step->time, rejected);
    for (int g = 0; g < groups; g++) {
      group[g].end = group[g].at;
      for (int a = 0; a < 3; a++)
        for (int l = 0; l < LANES; l++) group[g].end.x[a][l] += group[g].move[s % 2][a][l];
      lanes_settle(c, &group[g].end);
    }
    for (int g = 0; g < groups; g++) finish_flights(c, &group[g], s % 2, step->flight, rejected);
  }
  for (int w = 0; w < count; w++) walkers[w] = lanes_take(&group[w / LANES].at, w % LANES);
}

void walk_steps(const struct walk_cells *cells, const struct walk_step *step,
                struct walker *walkers, size_t count, uint64_t first, int steps,
                struct walk_rejected *rejected) {
  uint64_t advections = 0, flights = 0;
#pragma omp parallel for schedule(dynamic, 4) reduction(+ : advections, flights)
  for (size_t begin = 0; begin < count; begin += BLOCK) {
    struct walk_rejected own = {0};
    move_block(cells, step, walkers + begin, (int)(count - begin < BLOCK ? count - begin : BLOCK),
               first, steps, &own);
    advections += own.advections, flights += own.flights;
  }
  rejected->advections += advections, rejected->flights += flights;
}
