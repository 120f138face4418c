/* How one walker moves in a time step: advection with the water, then diffusion. Each of the two
 * moves preserves a uniform distribution of walkers over the pore, so that none accumulate
 * anywhere, however long they walk:
 *
 * - Diffusion: a straight flight of fixed length l = sqrt(6 D dt) in a random direction (its mean
 *   square along each axis is 2 D dt), reflected where it meets the wall. Flights with reflections
 *   preserve the volume in the space of position and direction whatever the shape of the wall
 *   (Liouville; billiards).
 *
 * - Advection: u is divergence-free, so following it for a time preserves volumes. In a cell cut by
 *   the wall, the streamlines fill the whole cube, and some reach the wall. A walker that has
 *   entered grain continues, within the same time step, until its streamline brings it back into
 *   the pore: this map of first return preserves volumes in the pore as the flow does in the cubes
 *   (Kac 1947, Bull. Amer. Math. Soc. 53, 1002). The full flux through each face is carried.
 *
 * All walkers have the same time step: with a step that depended on the position they would
 * accumulate where it is short. Where the water is fast, advection is divided into substeps
 * instead.
 */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_MOVE_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_MOVE_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/variants.h"
#include "sphsolve/solute/walk_cells.h"

#define WALK_SUBSTEP_MAX 0.5f     /* longest substep of advection, cells */
#define WALK_RETURN_STEPS_MAX 512 /* steps in grain after which the advection is rejected */
#define WALK_REFLECTIONS_MAX 8    /* reflections of one flight after which it is rejected */
#define WALK_AT_WALL 1e-4f        /* distance that counts as at the wall, first spacings */

/* 64 bytes: one cache line. */
struct walker {
  walk_vector x;      /* offset from the centre of the cell, in cells: -1/2 .. 1/2; lane 3 is 0 */
  walk_place wrapped; /* the cell in the box */
  walk_place cell;    /* the cell in the unwrapped periodic box */
  int32_t number;     /* of the cell in walk_cells; -1: grain */
  uint32_t address;   /* of the cell (walk_address) */
  uint32_t walls;     /* WALK_NEAR, WALK_CUT */
  uint32_t id;
};

enum { WALK_NEAR = 1, WALK_CUT = 2 };

/* HOT: inlined into each variant of the loop; COLD: needed by few walkers, kept out of it. */
#define WALK_HOT static inline __attribute__((always_inline))
#define WALK_COLD TARGETS static __attribute__((noinline, unused))

WALK_HOT walk_vector walk_all(float value) {
  return (walk_vector){value, value, value, value};
}

/* Number (-1: grain) and wall flags of the cell at an address. */
WALK_HOT void walk_look_up(const struct walk_cells *c, uint32_t address, int32_t *number,
                           uint32_t *walls) {
  const struct walk_brick *brick = &c->brick[address / 64];
  const unsigned bit = address % 64;
  const uint64_t below = brick->open & (((uint64_t)1 << bit) - 1);
  const int32_t open = -(int32_t)(brick->open >> bit & 1); /* all bits, or none */
  *number = ((int32_t)brick->first + __builtin_popcountll(below)) | ~open;
  *walls = (uint32_t)(brick->near >> bit & 1) | (uint32_t)(brick->cut >> bit & 1) << 1;
}

/* Looks up the walker's cell from its position in the box; false: grain. */
WALK_HOT bool walk_find(const struct walk_cells *c, struct walker *w) {
  w->address = walk_address(c, w->wrapped);
  walk_look_up(c, w->address, &w->number, &w->walls);
  return w->number >= 0;
}

/* Brings x back to -1/2 .. 1/2 and updates the cell, for displacements of at most one cell (two
 * steps by rounding, in a box of one cell); false: the new cell is grain. Without branches, because
 * it is unpredictable whether a walker leaves its cell. */
WALK_HOT bool walk_settle(const struct walk_cells *c, struct walker *w) {
  const walk_place n = {c->n[0], c->n[1], c->n[2], 1};
  const walk_vector up = w->x + walk_all(0.5f);
  walk_place step = __builtin_convertvector(up, walk_place); /* towards 0, */
  step += up < __builtin_convertvector(step, walk_vector);   /* and then down */
  w->x -= __builtin_convertvector(step, walk_vector);
  w->cell += step;
  w->wrapped += step;
  for (int turn = 0; turn < 2; turn++) {
    w->wrapped += (w->wrapped < 0) & n;
    w->wrapped -= (w->wrapped >= n) & n;
  }
  return walk_find(c, w);
}

/* Converts four of the cell's integer values. Eight are read; the record is long enough. */
WALK_HOT walk_vector walk_unpack(const int16_t *from) {
  typedef int16_t eight __attribute__((vector_size(16)));
  eight counted;
  memcpy(&counted, from, sizeof counted);
  const eight twice = __builtin_shufflevector(counted, counted, 0, 0, 1, 1, 2, 2, 3, 3);
  return __builtin_convertvector((walk_place)twice >> 16, walk_vector);
}

/* Wall distance, first spacings, trilinear between the corners of the cell. */
WALK_HOT float walk_distance(const struct walk_cells *c, const struct walker *w) {
  if (w->number < 0) return -1;
  const int16_t *corner = c->cell[w->number].corner;
  const walk_vector low = walk_unpack(corner), high = walk_unpack(corner + 4);
  const float x = w->x[0] + 0.5f, y = w->x[1] + 0.5f, z = w->x[2] + 0.5f;
  const walk_vector weight = {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
  const walk_vector sum = weight * (low + walk_all(z) * (high - low));
  return c->distance_unit * ((sum[0] + sum[1]) + (sum[2] + sum[3]));
}

/* Normalised gradient of the wall distance. */
WALK_COLD void walk_normal(const struct walk_cells *c, const struct walker *w, float g[3]) {
  const int16_t *d = c->cell[w->number].corner;
  const float x[3] = {w->x[0] + 0.5f, w->x[1] + 0.5f, w->x[2] + 0.5f};
  float square = 0;
  for (int a = 0; a < 3; a++) {
    const int p = (a + 1) % 3, q = (a + 2) % 3;
    g[a] = 0;
    for (int s = 0; s < 4; s++) {
      const int base = (s & 1) << p | (s >> 1) << q;
      const float share = (s & 1 ? x[p] : 1 - x[p]) * (s >> 1 ? x[q] : 1 - x[q]);
      g[a] += share * (float)(d[base | 1 << a] - d[base]);
    }
    g[a] *= c->stretch[a];
    square += g[a] * g[a];
  }
  const float by = square > 0 ? 1 / sqrtf(square) : 0;
  for (int a = 0; a < 3; a++) g[a] *= by;
}

/* Velocity at x in a cell, cells along the axis per time unit (walk_cells.h). */
WALK_HOT walk_vector walk_velocity(const struct walk_cells *c, int32_t number, walk_vector x) {
  const struct walk_cell *cell = &c->cell[number];
  const walk_vector low_next = walk_unpack(cell->slope[0]), low_last = walk_unpack(cell->slope[1]),
                    high_next = walk_unpack(cell->slope[2]),
                    high_last = walk_unpack(cell->slope[3]);
  walk_vector low, high; /* fluxes of the faces at the walker's position along them */
  memcpy(&low, cell->face[0], sizeof low);
  memcpy(&high, &cell->face[0][2], sizeof high); /* from one value earlier: the record ends here */
  high = __builtin_shufflevector(high, high, 1, 2, 3, 0);
  const walk_vector unit = walk_all(c->slope_unit), scaled = unit * x;
  const walk_vector next = __builtin_shufflevector(scaled, scaled, 1, 2, 0, 3);
  const walk_vector last = __builtin_shufflevector(scaled, scaled, 2, 0, 1, 3);
  low += low_next * next + low_last * last;
  high += high_next * next + high_last * last;
  /* The quadratic term along each axis that compensates the slopes of the other faces. */
  const walk_vector more_next = high_next - low_next, more_last = high_last - low_last;
  const walk_vector square = __builtin_shufflevector(more_last, more_last, 1, 2, 0, 3) +
                             __builtin_shufflevector(more_next, more_next, 2, 0, 1, 3);
  const walk_vector u = walk_all(0.5f) * (low + high) + (high - low) * x +
                        square * (walk_all(0.5f) * unit) * (walk_all(0.25f) - x * x);
  return (walk_vector)((walk_place)u & (walk_place){-1, -1, -1, 0});
}

WALK_HOT float walk_inside(float x) {
  return x < -0.5f ? -0.5f : x < 0.5f ? x : 0x1.fffffep-2f;
}

/* Moves by `move` cells. If that crosses a closed face, which can result from the error of a
 * substep, the walker stays in its cell. */
WALK_HOT void walk_shift(const struct walk_cells *c, struct walker *w, walk_vector move) {
  const struct walker from = *w;
  w->x += move;
  if (walk_settle(c, w)) return;
  *w = from;
  for (int a = 0; a < 3; a++) w->x[a] = walk_inside(w->x[a] + move[a]);
}

WALK_HOT float walk_largest(float u, float v, float w) {
  const float x = fabsf(u), y = fabsf(v), z = fabsf(w), most = x > y ? x : y;
  return most > z ? most : z;
}

/* Length in time of the next substep of advection; `left`: remaining time, `most`: the largest
 * velocity component, cells per time unit. */
WALK_HOT float walk_substep(float most, float left) {
  const float part = left * WALK_SUBSTEP_MAX / (most * left), half = 0.5f * left;
  return most * left > WALK_SUBSTEP_MAX ? (part < half ? part : half) : left;
}

WALK_HOT bool walk_in_pore(const struct walk_cells *c, const struct walker *w) {
  return !(w->walls & WALK_CUT) || walk_distance(c, w) > 0;
}

/* Advection for a time, in as many substeps as needed, through the whole cubes, each by the
 * midpoint rule. */
WALK_HOT void walk_advect(const struct walk_cells *c, struct walker *w, float time) {
  for (float left = time; left > 0;) {
    const walk_vector v = walk_velocity(c, w->number, w->x);
    const float part = walk_substep(walk_largest(v[0], v[1], v[2]), left);
    struct walker middle = *w;
    walk_shift(c, &middle, walk_all(0.5f * part) * v);
    walk_shift(c, w, walk_all(part) * walk_velocity(c, middle.number, middle.x));
    left -= part;
  }
}

/* Continues through grain until the walker is back in the pore; false: it was not. */
WALK_COLD bool walk_return(const struct walk_cells *c, struct walker *w, float time) {
  for (int r = 1; r < WALK_RETURN_STEPS_MAX; r++) {
    walk_advect(c, w, time);
    if (walk_in_pore(c, w)) return true;
  }
  return false;
}

/* Fraction of the flight `move` from `from`, which ends in grain, at which it meets the wall:
 * regula falsi with the Illinois modification (Dowell, Jarratt 1971). */
WALK_COLD float walk_find_wall(const struct walk_cells *c, const struct walker *from,
                               walk_vector move, float outside, struct walker *hit) {
  float low = 0, high = 1, inside = walk_distance(c, from) - WALK_AT_WALL;
  outside -= WALK_AT_WALL;
  *hit = *from;
  for (int step = 0, side = 0; step < 12 && inside > 0; step++) {
    const float t = low + (high - low) * inside / (inside - outside);
    struct walker at = *from;
    at.x += walk_all(t) * move;
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

/* Whether the reverse flight, from the end along `move` with this total length, is reflected as
 * well: a straight one could pass the edge of a grain. Only reversible moves preserve the uniform
 * distribution. */
WALK_COLD bool walk_reflects_back(const struct walk_cells *c, const struct walker *end,
                                  walk_vector move, float length) {
  float square = 0;
  for (int a = 0; a < 3; a++) square += (move[a] / c->stretch[a]) * (move[a] / c->stretch[a]);
  struct walker back = *end;
  back.x -= walk_all(square > 0 ? length / sqrtf(square) : 0) * move;
  walk_settle(c, &back);
  return !(walk_distance(c, &back) > 0);
}

/* A flight that ends in grain: to the wall, reflected there, and so on; false: rejected. */
WALK_COLD bool walk_reflect(const struct walk_cells *c, struct walker *w, walk_vector move,
                            float length) {
  const struct walker start = *w;
  for (int m = 0; m < WALK_REFLECTIONS_MAX; m++) {
    const struct walker from = *w;
    w->x += move;
    walk_settle(c, w);
    const float outside = walk_distance(c, w);
    if (outside > 0) {
      if (m == 0 || walk_reflects_back(c, w, move, length)) return true;
      break;
    }
    struct walker hit;
    float normal[3], along = 0;
    const float share = walk_find_wall(c, &from, move, outside, &hit);
    walk_normal(c, &hit, normal);
    for (int a = 0; a < 3; a++) along += normal[a] * move[a] / c->stretch[a];
    for (int a = 0; a < 3; a++)
      move[a] = (1 - share) * (move[a] - 2 * along * normal[a] * c->stretch[a]);
    *w = hit;
  }
  *w = start;
  return false;
}

#endif
