/* Weights of the links to and between sites of soil (effects/soil_drag.h, soil_viscosity.h), in a
 * form that leaves the operators convolutions: as a sum of products,
 *   w_ab = sum over s of V_s(a) V_s(b),
 *   sum over b of w_ab c_ab u_b = sum over s of V_s(a) sum over b of c_ab V_s(b) u_b
 * V_0 is 1 in pores and their link's weight in soil, the others are 0 in pores. These are the
 * columns of a Cholesky factor of w as a matrix over all soils there are; the last is the root of
 * what is left of w_aa, which is exact up to two soils; links between others of more have something
 * between the harmonic and the geometric mean. */
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
  /* [sites] Pores that lead nowhere but through soil. Nothing but soil limits what flows through
   * them: they are soil of ENCLOSED times the permeability of the most permeable soil, which is
   * wrong by no more than that part of their resistance. NULL: there are none, or the operator is
   * assembled. */
  uint8_t *enclosed;
  double enclosed_permeability; /* spacing^2 */
  double pivot;                 /* mobility of the second column over a pore's; 0: there are two */
  struct stokes_weights viscosity, mobility;
  bool thick_layer; /* the velocity falls over more than a part of a site beneath the surface */
  float *relative;  /* [n] mobility over a pore's */
  /* [n] its root. Residuals are made of momentum times this and continuity over this: both have the
   * size then that they have in the flux, where soil lets through 1e-8 of what pores do, too. */
  float *balance;
  bool *rows; /* [rows] whether a row has soil */
  /* [axes][n] What the links' mobilities make of a uniform gradient equal to the force, less the
   * force: it is taken from G p, as pressure less that of the force at rest is what kinks at the
   * surface of soil. */
  float *drawn;
};

/* The most that an operator has. */
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

/* NULL in *soil where the lattice has none; driving: pores lead through along it. Free with
 * stokes_soil_free. */
enum status stokes_soil_build(const struct lattice *lattice, const struct stokes_grid *grid,
                              const double driving[3], double unit, struct stokes_soil **soil);
void stokes_soil_free(struct stokes_soil **soil);

#endif
