/* How one walker moves in a time step: with the water, then by diffusion. Each of the two moves
 * leaves walkers that are spread evenly over the pore spread evenly, so that none gather anywhere,
 * however long they walk:
 *
 * - Diffusion: a straight flight of fixed length l = sqrt(6 D dt) in a random direction (its mean
 *   square along each axis is 2 D dt), mirrored where it meets the wall. Flights with mirrors keep
 *   volumes of place and direction whatever the shape of the wall (Liouville; billiards).
 *
 * - The water: u has no divergence, so to follow it for a time keeps volumes. In a cell that the
 *   wall cuts, the stream lines fill the whole cube, and some come up to the wall. A walker that
 * has entered grain goes on, at once and in no time, until its stream line brings it back into the
 *   pore: the map of first return, which keeps volumes in the pore as the flow does in the cubes
 *   (Kac 1947, Bull. Amer. Math. Soc. 53, 1002). The flux through each face is carried in full.
 *
 * The time step is one for all walkers: with a step that depended on the place they would gather
 * where it is short. Where the water is fast, the way with it is cut into parts instead. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_MOVE_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_MOVE_H

#include <math.h>
#include <stdbool.h>

#include "sphsolve/solute/walk_cells.h"

#define WALK_PART 0.5f     /* of a cell: the longest part of a way with the water */
#define WALK_RETURNS 512   /* steps in grain after which a walker stays where it was */
#define WALK_MIRRORS 8     /* of one flight, after which it stays too */
#define WALK_AT_WALL 1e-4f /* first spacings: so near is at the wall */

/* x, y, z and one more that stays 0: the four lanes of the smallest vector register. */
typedef float walk_vector __attribute__((vector_size(16)));
typedef int32_t walk_place __attribute__((vector_size(16)));

/* 64 bytes: one line of cache. */
struct walker {
  walk_vector x;      /* from the centre of the cell, in cells: -1/2 .. 1/2 */
  walk_place wrapped; /* the cell in the box */
  walk_place cell;    /* the same in the box that repeats without end */
  int32_t number;     /* of the cell in walk_cells; -1: grain */
  uint32_t id;
  uint32_t unused[2];
};

/* Copied into each variant of the loop; what few walkers need is left outside of it. */
#define WALK_HOT static inline __attribute__((always_inline))
#define WALK_COLD static __attribute__((noinline, unused))

WALK_HOT walk_vector walk_all(float value) {
  return (walk_vector){value, value, value, value};
}

WALK_HOT int32_t walk_number(const struct walk_cells *c, walk_place w) {
  return c->number[((int64_t)w[2] * c->n[1] + w[1]) * c->n[0] + w[0]];
}

/* Brings x back to -1/2 .. 1/2 and the cell with it, for ways of at most a cell (two steps by
 * rounding, in a box of one); false: that cell is grain. */
WALK_HOT bool walk_settle(const struct walk_cells *c, struct walker *w) {
  const walk_place n = {c->n[0], c->n[1], c->n[2], 1};
  const walk_vector up = w->x + walk_all(0.5f);
  walk_place step = __builtin_convertvector(up, walk_place); /* towards 0, */
  step += up < __builtin_convertvector(step, walk_vector);   /* and then down */
  if ((step[0] | step[1] | step[2]) == 0) return true;
  w->x -= __builtin_convertvector(step, walk_vector);
  w->cell += step;
  w->wrapped += step;
  for (int turn = 0; turn < 2; turn++) {
    w->wrapped += (w->wrapped < 0) & n;
    w->wrapped -= (w->wrapped >= n) & n;
  }
  w->number = walk_number(c, w->wrapped);
  return w->number >= 0;
}

/* Distance to the wall, first spacings, linear between the corners of the cell. */
WALK_HOT float walk_distance(const struct walk_cells *c, const struct walker *w) {
  if (w->number < 0) return -1;
  const walk_vector *d = (const walk_vector *)c->corner[w->number];
  const float x = w->x[0] + 0.5f, y = w->x[1] + 0.5f, z = w->x[2] + 0.5f;
  const walk_vector weight = {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
  const walk_vector sum = weight * (d[0] + walk_all(z) * (d[1] - d[0]));
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Its gradient, of length 1. */
WALK_COLD void walk_normal(const struct walk_cells *c, const struct walker *w, float g[3]) {
  const float *d = c->corner[w->number];
  const float x[3] = {w->x[0] + 0.5f, w->x[1] + 0.5f, w->x[2] + 0.5f};
  float square = 0;
  for (int a = 0; a < 3; a++) {
    const int p = (a + 1) % 3, q = (a + 2) % 3;
    g[a] = 0;
    for (int s = 0; s < 4; s++) {
      const int base = (s & 1) << p | (s >> 1) << q;
      const float share = (s & 1 ? x[p] : 1 - x[p]) * (s >> 1 ? x[q] : 1 - x[q]);
      g[a] += share * (d[base | 1 << a] - d[base]);
    }
    g[a] *= c->stretch[a];
    square += g[a] * g[a];
  }
  const float by = square > 0 ? 1 / sqrtf(square) : 0;
  for (int a = 0; a < 3; a++) g[a] *= by;
}

WALK_HOT walk_vector walk_velocity(const struct walk_cells *c, const struct walker *w) {
  const walk_vector *u = (const walk_vector *)c->cell[w->number].u;
  const walk_vector r = w->x, next = {r[1], r[2], r[0], 0}, last = {r[2], r[0], r[1], 0};
  return u[WALK_0] + u[WALK_X] * walk_all(r[0]) + u[WALK_Y] * walk_all(r[1]) +
         u[WALK_Z] * walk_all(r[2]) +
         r * (u[WALK_SQUARE] * r + u[WALK_CROSS_1] * next + u[WALK_CROSS_2] * last);
}

/* Moves by `way` cells. At a face that is closed, reached by the error of a part, the walker stays.
 */
WALK_HOT void walk_shift(const struct walk_cells *c, struct walker *w, walk_vector way) {
  const struct walker from = *w;
  w->x += way;
  if (walk_settle(c, w)) return;
  *w = from;
  for (int a = 0; a < 3; a++) w->x[a] = fminf(fmaxf(w->x[a] + way[a], -0.5f), 0x1.fffffep-2f);
}

WALK_HOT float walk_most(walk_vector v) {
  const float x = fabsf(v[0]), y = fabsf(v[1]), z = fabsf(v[2]), most = x > y ? x : y;
  return most > z ? most : z;
}

/* A part of the way with the water, by the midpoint rule; v is the velocity at its start. */
WALK_HOT void walk_part(const struct walk_cells *c, struct walker *w, walk_vector v, float time) {
  struct walker middle = *w;
  walk_shift(c, &middle, walk_all(0.5f * time) * v);
  walk_shift(c, w, walk_all(time) * walk_velocity(c, &middle));
}

WALK_HOT bool walk_in_pore(const struct walk_cells *c, const struct walker *w) {
  return c->cell[w->number].least > 0 || walk_distance(c, w) > 0;
}

/* The way with the water in as many parts as it takes, through the cubes. */
WALK_HOT void walk_follow(const struct walk_cells *c, struct walker *w, float time) {
  for (float left = time; left > 0;) {
    const walk_vector v = walk_velocity(c, w);
    const float most = walk_most(v) * left, half = 0.5f * left;
    float part = left;
    if (most > WALK_PART) part = left * WALK_PART / most < half ? left * WALK_PART / most : half;
    walk_part(c, w, v, part);
    left -= part;
  }
}

/* On through grain. */
WALK_COLD bool walk_return(const struct walk_cells *c, struct walker *w, float time) {
  for (int r = 1; r < WALK_RETURNS; r++) {
    walk_follow(c, w, time);
    if (walk_in_pore(c, w)) return true;
  }
  return false;
}

/* With the water for `time`; false: it did not come back from grain, and the walker stays. */
WALK_HOT bool walk_carry(const struct walk_cells *c, struct walker *w, float time) {
  struct walker end = *w;
  walk_follow(c, &end, time);
  if (!walk_in_pore(c, &end)) {
    struct walker far = end;
    if (!walk_return(c, &far, time)) return false;
    end = far;
  }
  *w = end;
  return true;
}

/* Where the flight `way` from `from`, which ends in grain, meets the wall, as a share of it; the
 * false position, with the halves of Illinois (Dowell, Jarratt 1971). */
WALK_COLD float walk_meet(const struct walk_cells *c, const struct walker *from, walk_vector way,
                          float outside, struct walker *hit) {
  float low = 0, high = 1, inside = walk_distance(c, from) - WALK_AT_WALL;
  outside -= WALK_AT_WALL;
  *hit = *from;
  for (int step = 0, side = 0; step < 12 && inside > 0; step++) {
    const float t = low + (high - low) * inside / (inside - outside);
    struct walker at = *from;
    at.x += walk_all(t) * way;
    walk_settle(c, &at);
    const float d = walk_distance(c, &at) - WALK_AT_WALL;
    if (d > -WALK_AT_WALL) low = t, *hit = at;
    if (fabsf(d) < WALK_AT_WALL) break;
    if (d > 0) {
      inside = d;
      if (side > 0) outside *= 0.5f;
    } else {
      high = t, outside = d;
      if (side < 0) inside *= 0.5f;
    }
    side = d > 0 ? 1 : -1;
  }
  return low;
}

/* Whether the flight back, which ends with `way` and has this length in all, is mirrored as well: a
 * straight one could pass a grain's edge. Only moves that could be made both ways keep walkers
 * even.
 */
WALK_COLD bool walk_mirrors_back(const struct walk_cells *c, const struct walker *end,
                                 walk_vector way, float length) {
  float square = 0;
  for (int a = 0; a < 3; a++) square += (way[a] / c->stretch[a]) * (way[a] / c->stretch[a]);
  struct walker back = *end;
  back.x -= walk_all(square > 0 ? length / sqrtf(square) : 0) * way;
  walk_settle(c, &back);
  return !(walk_distance(c, &back) > 0);
}

/* A flight that ends in grain: to the wall, mirrored there, and so on. */
WALK_COLD bool walk_mirror(const struct walk_cells *c, struct walker *w, walk_vector way,
                           float length) {
  const struct walker start = *w;
  for (int m = 0; m < WALK_MIRRORS; m++) {
    const struct walker from = *w;
    w->x += way;
    walk_settle(c, w);
    const float outside = walk_distance(c, w);
    if (outside > 0) {
      if (m == 0 || walk_mirrors_back(c, w, way, length)) return true;
      break;
    }
    struct walker hit;
    float normal[3], along = 0;
    const float share = walk_meet(c, &from, way, outside, &hit);
    walk_normal(c, &hit, normal);
    for (int a = 0; a < 3; a++) along += normal[a] * way[a] / c->stretch[a];
    for (int a = 0; a < 3; a++)
      way[a] = (1 - share) * (way[a] - 2 * along * normal[a] * c->stretch[a]);
    *w = hit;
  }
  *w = start;
  return false;
}

/* A flight by `way`, at most a cell, as if there were no walls; its cell is fetched meanwhile. */
WALK_HOT bool walk_take_off(const struct walk_cells *c, struct walker *end, walk_vector way) {
  end->x += way;
  const bool pore = walk_settle(c, end);
  if (!pore) return false;
  __builtin_prefetch(&c->cell[end->number]);
  __builtin_prefetch((const char *)&c->cell[end->number] + 64);
  return true;
}

/* The end of that flight, of `length` first spacings; false: it found none in the pore, and the
 * walker stays. */
WALK_HOT bool walk_land(const struct walk_cells *c, struct walker *w, const struct walker *end,
                        bool pore, walk_vector way, float length) {
  if (pore && (!c->cell[w->number].near || walk_in_pore(c, end))) {
    *w = *end;
    return true;
  }
  return walk_mirror(c, w, way, length);
}

#endif
