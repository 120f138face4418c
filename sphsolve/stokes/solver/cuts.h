/* Links of the stencil that a wall thinner than the spacing cuts (geometry/thin_wall.h). The
 * convolutions sum over all active neighbours; what they add for a neighbour behind such a wall is
 * subtracted again, link by link, and the wall takes its place. Without such walls there is no
 * list. */
#ifndef TOSUI_SPHSOLVE_STOKES_CUTS_H
#define TOSUI_SPHSOLVE_STOKES_CUTS_H

#include "sphsolve/geometry/thin_wall.h"
#include "sphsolve/stokes/solver/operator.h"

struct stokes_cut {
  uint32_t at;     /* index of the site in its packed row */
  uint32_t offset; /* of the stencil */
  size_t other;    /* index of the neighbour in an unpacked field */
  /* The wall seen from the site, in units of the stencil: distances of the site before and of the
   * neighbour behind it, and its normal. */
  float before, behind, normal[3];
};

/* Fills cuts and cut_start of an operator with stencil, grid and lattice. */
enum status stokes_cuts_build(struct stokes_operator *op);

/* The cut links of one site of a row, by its packed index: first entry, and *end. */
size_t stokes_cuts_of(const struct stokes_operator *op, size_t row, size_t at, size_t *end);

/* The cut link from a site to its next neighbour along an axis; NULL if it is not cut. `packed`:
 * index of the site in its packed row. */
const struct stokes_cut *stokes_cut_beside(const struct stokes_operator *op, size_t row,
                                           size_t packed, int axis, bool up);

/* Subtracts from sum [sites of the row] what a convolution of an unpacked field has added over cut
 * links. */
void stokes_cuts_subtract(const struct stokes_operator *op,
                          const struct stokes_convolution *convolution, size_t row,
                          const float *field, float *sum);
void stokes_cuts_subtract_double(const struct stokes_operator *op,
                                 const struct stokes_convolution *convolution, size_t row,
                                 const double *field, double *sum);

#endif
