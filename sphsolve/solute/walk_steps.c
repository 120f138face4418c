#include "sphsolve/solute/walk_steps.h"

#include "common/variants.h"
#include "sphsolve/solute/walk_random.h"

#define BLOCK 128 /* walkers whose places and ways lie in the first cache */

enum { FLIGHTS, STARTS }; /* streams of random numbers, the second half of the key */

void walk_draw(uint32_t id, uint32_t number, uint32_t seed, uint32_t words[4]) {
  words[0] = id, words[1] = number, words[2] = words[3] = 0;
  philox4x32(words, seed, STARTS);
}

/* Sine and cosine of pi t for |t| <= 1/2: the Taylor series to the 11th power, off by 6e-8. */
static inline void half_turn(float t, float *sine, float *cosine) {
  const float x = 3.14159265f * t, y = x * x;
  *sine =
      x * (1 + y * (-1.f / 6 + y * (1.f / 120 + y * (-1.f / 5040 +
                                                     y * (1.f / 362880 - y * (1.f / 39916800))))));
  *cosine = 1 + y * (-1.f / 2 +
                     y * (1.f / 24 + y * (-1.f / 720 + y * (1.f / 40320 - y * (1.f / 3628800)))));
}

/* Ways of flights in directions that are even over the sphere: the height is even between -1 and 1
 * (Archimedes), the angle over a turn. Two steps of each walker. */
static inline __attribute__((always_inline)) void
draw_flights(const struct walk_cells *c, const struct walk_step *step, const struct walker *walkers,
             int count, uint64_t number, float way[2][3][BLOCK]) {
  uint32_t words[4][BLOCK];
  for (int w = 0; w < count; w++) {
    uint32_t draw[4] = {walkers[w].id, (uint32_t)(number / 2), (uint32_t)(number / 2 >> 32), 0};
    philox4x32(draw, step->seed, FLIGHTS);
    for (int i = 0; i < 4; i++) words[i][w] = draw[i];
  }
  for (int s = 0; s < 2; s++)
    for (int w = 0; w < count; w++) {
      const float height = 2 * random_share(words[2 * s][w]) - 1;
      const float across = sqrtf(1 - height * height) * step->flight;
      float sine, cosine; /* of half the angle, and of the whole one from them */
      half_turn(random_share(words[2 * s + 1][w]) - 0.5f, &sine, &cosine);
      way[s][0][w] = across * (1 - 2 * sine * sine) * c->stretch[0];
      way[s][1][w] = across * (2 * sine * cosine) * c->stretch[1];
      way[s][2][w] = height * step->flight * c->stretch[2];
    }
}

TARGETS static void move_block(const struct walk_cells *c, const struct walk_step *step,
                               struct walker *walkers, int count, uint64_t first, int steps,
                               struct walk_kept *kept) {
  float way[2][3][BLOCK];
  struct walker end[BLOCK];
  bool pore[BLOCK];
  for (int s = 0; s < steps; s++) {
    if (s % 2 == 0) draw_flights(c, step, walkers, count, first + (uint64_t)s, way);
    for (int w = 0; w < count; w++) {
      const walk_vector flight = {way[s % 2][0][w], way[s % 2][1][w], way[s % 2][2][w], 0};
      struct walker at = walkers[w];
      if (step->time > 0) kept->carried += !walk_carry(c, &at, step->time);
      walkers[w] = at;
      pore[w] = walk_take_off(c, &at, flight);
      end[w] = at;
    }
    for (int w = 0; w < count; w++) {
      const walk_vector flight = {way[s % 2][0][w], way[s % 2][1][w], way[s % 2][2][w], 0};
      kept->flown += !walk_land(c, &walkers[w], &end[w], pore[w], flight, step->flight);
    }
  }
}

void walk_steps(const struct walk_cells *cells, const struct walk_step *step,
                struct walker *walkers, size_t count, uint64_t first, int steps,
                struct walk_kept *kept) {
  uint64_t carried = 0, flown = 0;
#pragma omp parallel for schedule(dynamic, 4) reduction(+ : carried, flown)
  for (size_t begin = 0; begin < count; begin += BLOCK) {
    struct walk_kept own = {0};
    move_block(cells, step, walkers + begin, (int)(count - begin < BLOCK ? count - begin : BLOCK),
               first, steps, &own);
    carried += own.carried, flown += own.flown;
  }
  kept->carried += carried, kept->flown += flown;
}
