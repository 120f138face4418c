/* Multigrid for a symmetric seven-point operator on a periodic lattice,
 *   (T u)_a = sum over the six faces of t_ab (u_a - u_b) + m_a u_a,
 * with blocks of 2^3 sites as coarse sites. Used from the second level on: on its own lattice
 * method stokes smooths with its own stencil. */
#ifndef TOSUI_SPHSOLVE_STOKES_MULTIGRID_H
#define TOSUI_SPHSOLVE_STOKES_MULTIGRID_H

#include <stddef.h>

#include "common/error.h"
#include "common/slabs.h"

#define MULTIGRID_LEVELS 12

struct stokes_multigrid_level {
  size_t size[3], count;
  size_t begin, end;         /* planes of this rank; all planes if every rank has the whole level */
  const struct slabs *slabs; /* NULL: every rank has the whole level */
  size_t *start;             /* planes of each rank, if this is the first level that all have */
  int shift;                 /* a plane of this level covers 2^shift planes of the lattice */
  float *face[3];            /* t to the next site along x, y, z; 0: no connection */
  float *mass;               /* m */
  float *inverse;            /* 1 / diagonal, 0 for a site without any coupling */
  float *u, *b, *r;
};

struct stokes_multigrid {
  int level_count;
  struct stokes_multigrid_level levels[MULTIGRID_LEVELS];
};

/* Allocates all levels, the first one with `size` sites. `slabs` (kept) divide the lattice, and
 * also the first `shared` levels, among the ranks. The caller fills face and mass of levels[0],
 * then calls stokes_multigrid_coarsen. Free with stokes_multigrid_free. */
enum status stokes_multigrid_build(const size_t size[3], const struct slabs *slabs, int shared,
                                   struct stokes_multigrid *multigrid);
void stokes_multigrid_coarsen(struct stokes_multigrid *multigrid);
void stokes_multigrid_free(struct stokes_multigrid *multigrid);

/* One cycle from u = 0: levels[0].b in, levels[0].u out; each level visits the next `visits` times,
 * 1 for a V-cycle, 2 for a W-cycle. A fixed, symmetric, linear operation. */
void stokes_multigrid_cycle(struct stokes_multigrid *multigrid, int visits);

#endif
