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

/* How far particle i is part of a body of water, 0 .. 1, by what other water fills around it. The
 * reduced pressure cannot carry the weight of a lone drop, whose gradient sees no neighbours: for
 * it the pressure and the driving force act apart. */
static inline double surface_company(const struct isph *s, size_t i) {
  double others = s->filling[i] - s->filling_walls[i] - s->filling_alone;
  double whole = (others - 0.1) * 5;
  return whole < 0 ? 0 : whole > 1 ? 1 : whole;
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

/* Closes the gradients of q = P - rho f.x and of P at particle i against the void; returns its
 * company. */
static inline double surface_close(const struct isph *s, size_t i, double reduced[3],
                                   double own[3]) {
  const double *m = s->imbalance[i], *f = s->force;
  double w = s->surface[i];
  if (w <= 0) return 1;
  double size = s->dimensions == 3 ? cbrt(s->volume[i]) : sqrt(s->volume[i]);
  double length = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]), pressure = s->pressure[i];
  double d = 0.5 * size / fmax(length, 1e-30);
  double level = pressure + s->density * d * (f[0] * m[0] + f[1] * m[1] + f[2] * m[2]);
  for (int a = 0; a < 3; a++) {
    reduced[a] -= 2 * w * level * m[a];
    own[a] -= 2 * w * pressure * m[a];
  }
  return surface_company(s, i);
}

#endif
