#include "sphsolve/solute/walk_steps.h"

#include "common/variants.h"
#include "sphsolve/solute/walk_lanes.h"
#include "sphsolve/solute/walk_random.h"

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
