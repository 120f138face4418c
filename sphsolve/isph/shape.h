/* Weights exp(n.S.n) on directions n that have a given second moment (isph/anisotropy.h). */
#ifndef TOSUI_SPHSOLVE_ISPH_SHAPE_H
#define TOSUI_SPHSOLVE_ISPH_SHAPE_H

#include <stddef.h>

/* Directions around a particle with their weights; more than there is room for are left out. */
#define ISPH_DIRECTIONS 512
struct isph_directions {
  size_t count;
  double weight[ISPH_DIRECTIONS], n[ISPH_DIRECTIONS][3];
};
/* A neighbour at r that counts weight r r; adds that to `moment`. */
void isph_directions_add(struct isph_directions *around, const double r[3], double weight,
                         double moment[6]);

/* S with sum weight exp(n.S.n) n n = target, or, where the directions do not allow that, near it;
 * sought from `start`. */
void isph_shape_find(int dimensions, const struct isph_directions *around, const double target[6],
                     const double start[6], float shape[6]);
/* The same for directions spread evenly, of a moment that would be 1. */
void isph_shape_even(int dimensions, const double target[6], double shape[6]);

#endif
