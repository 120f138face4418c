/* A floor under the eddy viscosity of water with a surface under gravity:
 *   nu + max(nu_T, nu_c),   nu_c = 0.08 r0 sqrt(|f| r0),  r0 the particle spacing.
 * The projection is approximate: what its pressure does not see (a few 1e-5 of the energy a second)
 * goes into eddies of some spacings. Without the floor they keep a tank 20 cm deep of 20 particles
 * stirring at 3 to 9 mm/s, with a quarter or half of it at 2 to 7 mm/s, with it at under .1 mm/s.
 * It is of first order and a half in r0; a wave of length L loses 2 nu_c (2 pi / L)^2 of its height
 * a second. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_CALMING_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_CALMING_H

#include <math.h>

#include "sphsolve/isph/state.h"

#define CALMING 0.08

static inline double calming_viscosity(const struct isph *s) {
  const double *f = s->force;
  double strength = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  return CALMING * s->spacing * sqrt(strength * s->spacing);
}

#endif
