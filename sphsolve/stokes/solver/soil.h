/* Weights of the links to and between sites of soil (effects/soil_drag.h, soil_viscosity.h), as
 * sums of products, so that the operators stay convolutions: w_ab = sum over s of V_s(a) V_s(b),
 *   sum over b of w_ab c_ab u_b = sum over s of V_s(a) sum over b of c_ab V_s(b) u_b.
 * In pores V_0 is 1 and the others are 0; in soil V_0 is the weight of a link to a pore. The V are
 * the first columns of a Cholesky factor of w, regarded as a matrix over all kinds of soil; the
 * last one is the square root of the remainder of w_aa. This is exact for up to two soils; with
 * more, links between different soils have a weight between the harmonic and the geometric mean. */
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
  /* [sites] Enclosed pores: those connected only through soil, which alone limits the flow through
   * them. They are treated as soil of ENCLOSED_FACTOR times the largest permeability of soil (1),
   * or of that permeability (2); the error is this small part of the resistance. NULL: there are
   * none, or the operator is already assembled. */
  uint8_t *enclosed;
  double enclosed_permeability; /* spacing^2 */
  double pivot;                 /* mobility of the second column over a pore's; 0: two columns */
  struct stokes_weights viscosity, mobility;
  bool thick_layer; /* the boundary layer beneath the surface is not much thinner than a site */
  float *relative;  /* [n] mobility over that of a pore */
  /* [n] Square root of `relative`. Momentum residuals are multiplied and continuity residuals
   * divided by it: both then have the size of their effect on the flux, even where the mobility of
   * soil is 1e-8 of that of pores. */
  float *row_scale;
  bool *rows; /* [rows] whether a row contains soil */
  /* [axes][n] G applied to a pressure whose gradient is the force everywhere, minus the force. It
   * is subtracted from G p, because at the surface of soil it is the gradient of the pressure
   * without its hydrostatic part that jumps. */
  float *force_defect;
};

/* The larger number of products, of the weights of viscosity and of mobility. */
static inline int stokes_soil_sums(const struct stokes_soil *soil) {
  const int viscosity = soil->viscosity.count, mobility = soil->mobility.count;
  return viscosity > mobility ? viscosity : mobility;
}

/* Properties of a site, in lattice units. */
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

/* Whether a site is soil or an enclosed pore. */
bool stokes_soil_is(const struct stokes_soil *soil, const struct lattice *lattice, size_t site);

/* Whether two sites are both pores, or soil of the same kind. */
static inline bool stokes_soil_alike(const struct stokes_soil *soil, const struct lattice *lattice,
                                     size_t a, size_t b) {
  return lattice->micro_porosity[a] == lattice->micro_porosity[b] &&
         lattice->micro_permeability[a] == lattice->micro_permeability[b] &&
         (soil->enclosed == NULL || soil->enclosed[a] == soil->enclosed[b]);
}

/* Builds the weights; *soil stays NULL if the lattice has no soil. `driving` (m/s^2): pores that
 * lead through the box along it are not enclosed; `unit`: m per spacing. Free with
 * stokes_soil_free. */
enum status stokes_soil_build(const struct lattice *lattice, const struct stokes_grid *grid,
                              const double driving[3], double unit, struct stokes_soil **soil);
void stokes_soil_free(struct stokes_soil **soil);

#endif
