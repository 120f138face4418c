/* The steady SPH-Stokes system on the active sites, matrix-free, in lattice units (length: mean
 * spacing; kinematic viscosity and density 1):
 *   A v + D G p = D f,   div v + gamma (L + div G) p = 0
 *   (A v)_a = sum_b c_ab (v_a - v_b), c_ab = -2 (1/r) dW/dr          Morris, Fox, Zhu 1997 eq. 22
 *   wall site b: v_b = v_w + (v_w - v_a) d_b / d_a, continued by the parabola of the momentum
 *   equation, - (f - G p)_a d_b (d_a + d_b) / 2                      after Basa et al. 2009
 * The parabola is local to site a, so it scales that site's momentum equation by
 * D_a = 1 - sum over wall sites of c_ab d_b (d_a + d_b) / 2 and needs no outer iteration.
 *   (G p)_a = B_a sum over pore sites of (p_b - p_a) g_ab; div is minus its transpose. B inverts
 *   the moments sum of g_ab r_ab (Bonet, Lok 1999): without it a pressure gradient along a wall,
 *   and the flux along it, count for half in the sites next to the wall.
 *   L: the Laplacian with c_ab over pore pairs; gamma keeps checkerboard pressures out. For
 *   smooth p the two Laplacians L and -div G cancel, and with them its error (Rhie, Chow 1983). */
#ifndef TOSUI_SPHSOLVE_STOKES_OPERATOR_H
#define TOSUI_SPHSOLVE_STOKES_OPERATOR_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/stokes/solver/grid.h"
#include "sphsolve/stokes/solver/soil.h"
#include "sphsolve/stokes/solver/stencil.h"
#include "sphsolve/scene/scene.h"

/* Where entry (a, b) of a symmetric matrix is kept. */
static inline size_t stokes_symmetric(int axes, int a, int b) {
  return (size_t)(a == b ? a : axes + a + b - 1);
}

/* Correction of the contribution of a site at the end of a line to the volume integral: factors of
 * v and (f - G p). */
struct stokes_edge {
  uint32_t at; /* index in the packed row */
  float velocity, force;
};

struct stokes_operator {
  const struct stokes_stencil *stencil;
  const struct stokes_grid *grid;
  const struct lattice *lattice;
  const struct scene *scene; /* may be NULL */
  double velocity_unit;      /* m/s */
  double force[3];           /* driving force; with soil it is treated as part of the gradient */
  const struct stokes_rows *rows;
  enum wall_scheme wall;
  double stabilisation;      /* gamma of the equations */
  double laplace;            /* factor of L: with soil, such that L and div G cancel for linear p */
  int components;            /* axis_count velocities, then the pressure */
  size_t n;                  /* active sites; vectors are [components][n] */
  float *diagonal;           /* [n] diagonal of A */
  float *parabola;           /* [n] D */
  float *pore_sum;           /* [n] sum of c_ab over pore sites: diagonal of L */
  float *pore_gradient;      /* [axis_count][n] sum of g_ab over pore sites */
  float *correction;         /* [axis_count (axis_count + 1) / 2][n] B, see stokes_symmetric */
  float *drag;               /* [axis_count][n] of moving walls; NULL: none moves */
  struct stokes_edge *edges; /* sites with a wall beside them, row by row */
  size_t *edge_start;        /* [rows + 1] */
  float (*edge_moving)[3];   /* contribution of moving walls; NULL: none moves */
  struct stokes_cut *cuts;   /* links cut by thin walls (cuts.h), row by row; NULL: none */
  size_t *cut_start;         /* [rows + 1] */
  double *row_flux;          /* [rows][3] */
  struct stokes_soil *soil;  /* weights of links to soil; NULL: there is none, all weights are 1 */
  float *field;              /* [4][rows][stride] unpacked vectors, or two in double precision; with
                              * soil as many for each sum over its weights */
  float *scratch;            /* [threads][scratch_size] */
  size_t scratch_size;
  int threads;
};

/* Assembles the operator. Distances and kinds of sites come from `lattice`; stencil, grid and
 * lattice must outlive the operator. `scene` (may be NULL) gives walls their velocity and slip;
 * velocity_unit: the lattice unit of velocity in m/s; force as in stokes_operator_residual. Free
 * with stokes_operator_free. */
enum status stokes_operator_build(const struct stokes_stencil *stencil,
                                  const struct stokes_grid *grid, const struct lattice *lattice,
                                  const struct scene *scene, enum wall_scheme wall,
                                  double stabilisation, double velocity_unit, const double force[3],
                                  struct stokes_operator *op);
void stokes_operator_free(struct stokes_operator *op);

/* y = K x. */
void stokes_operator_apply(struct stokes_operator *op, const float *x, float *y);
/* The velocity block alone, for one component [n]: y = A x. component: the axis, or -1 for an even
 * field on a mirrored lattice. For preconditioning only: where drag dominates in soil, links
 * between two sites of soil have the product of their viscosities to a pore, which is less than
 * their true viscosity. */
void stokes_operator_apply_viscous(struct stokes_operator *op, int component, const float *x,
                                   float *y);
/* Sets odd components of y to zero on a mirror plane that holds sites: there the rows contain
 * rounding errors only. */
void stokes_operator_clear_plane(const struct stokes_operator *op, float *y);
/* y = G p, y [axis_count][n]. */
void stokes_operator_apply_gradient(struct stokes_operator *op, const float *p, float *y);

/* residual = (D force + drag, 0) - K x in double precision, rounded at the end. force by axis
 * number (x, y, z); work [n]. */
void stokes_operator_residual(struct stokes_operator *op, const double force[3], const double *x,
                              double *work, float *residual);
/* The same for x = 0; not with soil, where the residual at rest has further terms. */
void stokes_operator_right_side(const struct stokes_operator *op, const double force[3],
                                float *residual);
/* Volume integral of the velocity over the pores; p_gradient: G p as apply_gradient gives it. */
void stokes_operator_flux(struct stokes_operator *op, const double force[3], const double *x,
                          const float *p_gradient, double flux[3]);

/* The field of a slot, 0 to 3: [rows][stride]; may be used between two calls of the above. */
static inline float *stokes_operator_field(const struct stokes_operator *op, int slot) {
  return op->field + (size_t)slot * op->grid->rows * op->grid->stride;
}
/* Within a parallel region: unpacks a packed vector into the field of `slot` and starts the
 * exchange of its ghosts; `component` as in stokes_grid_post. */
void stokes_operator_unpack(struct stokes_operator *op, const float *packed, int slot,
                            int component);

/* out = B in at site i; in [axis_count][pitch]. */
static inline void stokes_correct(const struct stokes_operator *op, size_t i, const float *in,
                                  size_t pitch, float out[3]) {
  const int axes = op->stencil->axis_count;
  for (int a = 0; a < axes; a++) {
    out[a] = 0.0f;
    for (int b = 0; b < axes; b++)
      out[a] +=
          op->correction[stokes_symmetric(axes, a, b) * op->n + i] * in[(size_t)b * pitch + i];
  }
}

/* The region whose wall contains a site; NULL: none. */
static inline const struct region *stokes_wall_region(const struct stokes_operator *op,
                                                      size_t site) {
  if (!op->scene || !op->lattice->region || op->lattice->region[site] == 0) return NULL;
  return &op->scene->regions[op->lattice->region[site] - 1];
}

static inline bool stokes_wall_slips(const struct stokes_operator *op, size_t site) {
  const struct region *region = stokes_wall_region(op, site);
  return region && region->slip;
}

#endif
