/* Free surface: P = 0 half a particle above the outermost particles.
 *
 * Where neighbours are missing (filling = sum V W of water and walls below 1) a row of the pressure
 * equation is closed by a ghost in the void, as Nair, Tomar (2014, Comput. Fluids 102) close
 * theirs, but with the ghost's place chosen so that it is exact at rest: the pairs that are missing
 * have the moment Q = -sum a_ij (x_i - x_j); one ghost at the surface point x_s = x_i + n d, n =
 * Q/|Q|, d = V^(1/dimensions)/2, with coefficient c = |Q|/d has the same moment. Its row entry is
 *   c [ P_i - rho f.(x_i - x_s) ] = c P_i + rho f.Q
 * Water at rest with a level surface then has P = rho g (z_s - z) exactly, and a falling body of
 * water P = 0. The weight goes smoothly from 0 to 1, so that nothing jumps when particles pass. */
#ifndef TOSUI_SPHSOLVE_EFFECTS_ISPH_SURFACE_H
#define TOSUI_SPHSOLVE_EFFECTS_ISPH_SURFACE_H

#include <math.h>

#include "sphsolve/isph/isph_state.h"

/* Filling of a lattice: .79 in the outermost layer (2-D .78), .997 in the second. */
#define SURFACE_FILLING_BULK 0.95
#define SURFACE_FILLING_OPEN 0.87

static inline double surface_weight(double filling) {
  double w = (SURFACE_FILLING_BULK - filling) / (SURFACE_FILLING_BULK - SURFACE_FILLING_OPEN);
  return w < 0 ? 0 : w > 1 ? 1 : w;
}

/* What the surface adds to the diagonal and to the right-hand side of row i; `pairs` is the sum of
 * the a_ij of its neighbours. */
static inline void surface_row(const struct isph *s, size_t i, double pairs, double *coefficient,
                               double *load) {
  double w = s->surface[i];
  *coefficient = *load = 0;
  if (w <= 0) return;
  double size = s->dimensions == 3 ? cbrt(s->volume[i]) : sqrt(s->volume[i]);
  double scale = 2 * s->volume[i] * s->mobility[i];
  const double *m = s->imbalance[i], *f = s->force;
  double moment = scale * sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
  double missing = scale * s->slope_sum / (size * size) - pairs;
  *coefficient = w * fmax(moment / (0.5 * size), missing);
  *load = -w * s->density * scale * (f[0] * m[0] + f[1] * m[1] + f[2] * m[2]);
}

#endif
