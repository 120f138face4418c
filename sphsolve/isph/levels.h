/* The nested grids of the preconditioner: trilinear finite elements of div k grad on cells whose
 * number is halved from level to level, and one symmetric V-cycle over them. It knows nothing of
 * particles. */
#ifndef TOSUI_SPHSOLVE_ISPH_LEVELS_H
#define TOSUI_SPHSOLVE_ISPH_LEVELS_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

#define LEVELS 12

struct level {
  int cells[3], nodes[3]; /* an unused axis has 1 node and 1 cell of height 1 */
  bool periodic[3];
  double h[3];
  size_t node_count, cell_count, node_capacity, cell_capacity;
  double *k;      /* [cells]: mean coefficient */
  double *tie;    /* [nodes]: lumped coefficients that tie the pressure to a given one */
  float *stencil; /* [nodes][27] */
  double *x, *b, *r;
  int *lower[3], *upper[3]; /* neighbours along an axis; the node itself if there is none */
};

struct levels {
  int count;
  bool used[3];
  struct level at[LEVELS]; /* the finest first */
};

static inline size_t level_node(const struct level *level, int i, int j, int k) {
  return ((size_t)k * (size_t)level->nodes[1] + (size_t)j) * (size_t)level->nodes[0] + (size_t)i;
}

/* Sets up cells of about two spacings over a box of this extent, and all coarser levels, with
 * coefficients and ties of zero. Memory is kept between calls. */
enum status levels_shape(struct levels *levels, const double extent[3], const bool used[3],
                         const bool periodic[3], double spacing);
/* Finds coefficients and ties of the coarser levels and the matrices of all levels, from those of
 * the finest. */
void levels_assemble(struct levels *levels);
/* One V-cycle: x = B b on the finest level. */
void levels_cycle(struct levels *levels);
void levels_free(struct levels *levels);

#endif
