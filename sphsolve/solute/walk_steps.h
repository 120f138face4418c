/* The main loop: many steps of many walkers. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_STEPS_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_STEPS_H

#include <stddef.h>

#include "sphsolve/solute/walk_move.h"

struct walk_step {
  float time;    /* of advection, time units: 0 at rest */
  float flight;  /* length of a flight, first spacings */
  uint32_t seed; /* of the random numbers */
};

/* Numbers of rejected moves: advection or flights that did not end in the pore. */
struct walk_rejected {
  uint64_t advections, flights;
};

/* Does `steps` steps of each walker, beginning with step number `first` (both even: two steps share
 * one set of random words). The results are bitwise the same for any number of threads and any
 * order of walkers. */
void walk_steps(const struct walk_cells *cells, const struct walk_step *step,
                struct walker *walkers, size_t count, uint64_t first, int steps,
                struct walk_rejected *rejected);

/* Random words of a walker for purposes other than flights, such as its start. */
void walk_draw(uint32_t id, uint32_t number, uint32_t seed, uint32_t words[4]);

#endif
