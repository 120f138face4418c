/* Many walkers, many steps: the loop where the time goes. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_STEPS_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_STEPS_H

#include <stddef.h>

#include "sphsolve/solute/walk_move.h"

struct walk_step {
  float time;    /* with the water, time units: 0 at rest */
  float flight;  /* length of a flight, first spacings */
  uint32_t seed; /* of the random numbers */
};

/* Walkers that did not move: their displacement with the water, or their flight, found no end. */
struct walk_kept {
  uint64_t carried, flown;
};

/* `steps` steps of each walker from step number `first` on (even, and `steps` even: each two take
 * one draw of random words). The same bits for any number of threads and any order of walkers. */
void walk_steps(const struct walk_cells *cells, const struct walk_step *step,
                struct walker *walkers, size_t count, uint64_t first, int steps,
                struct walk_kept *kept);

/* Words of the random numbers of one walker that are no flights: from its start. */
void walk_draw(uint32_t id, uint32_t number, uint32_t seed, uint32_t words[4]);

#endif
