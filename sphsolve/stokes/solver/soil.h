/* Weights of the links to and between sites of soil (effects/soil_drag.h, soil_viscosity.h), as
 * sums of products, so that the operators stay convolutions: w_ab = sum over s of V_s(a) V_s(b),
 *   sum over b of w_ab c_ab u_b = sum over s of V_s(a) sum over b of c_ab V_s(b) u_b.
 * V_0 is 1 in pores and the weight of a link to a pore in soil; the others are 0 in pores. The V
 * are the first columns of a Cholesky factor of w, taken as a matrix over all kinds of soil; the
 * last one is the root of the remainder of w_aa. This is exact for up to two soils; of more, links
 * between different soils have a weight between the harmonic and the geometric mean. */
#ifndef TOSUI_SPHSOLVE_STOKES_SOLVER_SOIL_H
#define TOSUI_SPHSOLVE_STOKES_SOLVER_SOIL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/stokes/solver/grid.h"

#define STOKES_SOIL_SUMS 3

struct stokes_weights {
  int count;                      /* 2 or 3 */
  float *value[STOKES_SOIL_SUMS]; /* V [n] */
};

struct stokes_soil {
  double unit; /* m */
  /* [sites] Pores that lead nowhere but through soil, which alone limits the flow through them.
   * They are taken as soil of ENCLOSED times the largest permeability of soil (1), or of that
   * permeability (2): the error is that small part of the resistance. NULL: there are none, or the
   * operator is assembled. */
  uint8_t *enclosed;
  double enclosed_permeability; /* spacing^2 */
  double pivot;                 /* mobility of the second column over a pore's; 0: there are two */
  struct stokes_weights viscosity, mobility;
  bool thick_layer; /* the velocity falls over more than a part of a site beneath the surface */
  float *relative;  /* [n] mobility over a pore's */
  /* [n] its root. Residuals are of the momentum equation times this, and of continuity divided by
   * this: both then have the size of their effect on the flux, also where soil lets through 1e-8 of
   * what pores do. */
  float *row_scale;
  bool *rows; /* [rows] whether a row has soil */
  /* [axes][n] G applied to a pressure whose gradient is the force everywhere, less the force: it is
   * subtracted from G p, since it is the pressure without its hydrostatic part whose gradient jumps
   * at the surface of soil. */
  float *force_defect;
};

/* The larger number of products of the two. */
static inline int stokes_soil_sums(const struct stokes_soil *soil) {
  const int viscosity = soil->viscosity.count, mobility = soil->mobility.count;
  return viscosity > mobility ? viscosity : mobility;
}

/* What a site is, in lattice units. */
struct stokes_soil_site {
  bool soil;
  double permeability, slip, relative;
  double viscosity[STOKES_SOIL_SUMS], mobility[STOKES_SOIL_SUMS]; /* V */
};
struct stokes_soil_site stokes_soil_at(const struct stokes_soil *soil,
                                       const struct lattice *lattice, size_t site);
static inline double stokes_soil_weight(const double a[STOKES_SOIL_SUMS],
                                        const double b[STOKES_SOIL_SUMS]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Whether a site is soil, or a pore that leads nowhere else. */
bool stokes_soil_is(const struct stokes_soil *soil, const struct lattice *lattice, size_t site);

/* Whether two sites are pores both, or soil of one kind. */
static inline bool stokes_soil_alike(const struct stokes_soil *soil, const struct lattice *lattice,
                                     size_t a, size_t b) {
  return lattice->micro_porosity[a] == lattice->micro_porosity[b] &&
         lattice->micro_permeability[a] == lattice->micro_permeability[b] &&
         (soil->enclosed == NULL || soil->enclosed[a] == soil->enclosed[b]);
}

/* *soil is NULL where the lattice has none. `driving` (m/s^2): pores that lead through the box
 * along it are not enclosed; `unit`: m a spacing. Free with stokes_soil_free. */
enum status stokes_soil_build(const struct lattice *lattice, const struct stokes_grid *grid,
                              const double driving[3], double unit, struct stokes_soil **soil);
void stokes_soil_free(struct stokes_soil **soil);

#endif
