/* Weights exp(n.S.n) of directions n with a given second moment (isph/anisotropy.h). */
#ifndef TOSUI_SPHSOLVE_ISPH_SHAPE_H
#define TOSUI_SPHSOLVE_ISPH_SHAPE_H

#include <stddef.h>

/* Unit vectors to the neighbours of a particle with their weights; those beyond ISPH_DIRECTIONS are
 * left out. */
#define ISPH_DIRECTIONS 512
struct isph_directions {
  size_t count;
  double weight[ISPH_DIRECTIONS], n[ISPH_DIRECTIONS][3];
};
/* Adds a neighbour at separation r; also adds weight r r to `moment`. */
void isph_directions_add(struct isph_directions *around, const double r[3], double weight,
                         double moment[6]);

/* Finds S such that sum weight exp(n.S.n) n n = target, or is near it if the directions do not
 * allow that. `start` is the initial guess. */
void isph_shape_find(int dimensions, const struct isph_directions *around, const double target[6],
                     const double start[6], float shape[6]);
/* The same for directions spread evenly, whose moment without S is the identity. */
void isph_shape_even(int dimensions, const double target[6], double shape[6]);

#endif
