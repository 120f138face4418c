/* The gradient of the pressure, exact for linear fields in free water (Randles, Libersky 1996,
 * Comput. Methods Appl. Mech. Eng. 139; Bonet, Lok 1999, same 180), where a driving force acts and
 * there is neither soil nor window nor well. With the moment of a neighbourhood, images and walls
 * in it,
 *   M = sum V slope r r,
 * the identity on the lattice, it is multiplied by
 *   K = (1 - w) M^-1 + w [ 1 + (1/m - 1) (1 - n n) ],
 * w how far the particle is on the surface, n its normal and m the mean of M along the surface.
 * Half of a neighbourhood is missing there: across the surface a ghost closes the gradient
 * (effects/surface.h), along it nothing else does, and the outermost row of a wave would be a
 * quarter slower than the wave. The divergence has M^-1 only where water strains fast
 * (isph/strain.h). */
#ifndef TOSUI_SPHSOLVE_ISPH_LINEAR_H
#define TOSUI_SPHSOLVE_ISPH_LINEAR_H

#include <stdbool.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/isph/symmetric.h"

/* Whether it is the water that the above is for. */
static inline bool isph_is_free_water(const struct isph *s) {
  return s->on.surface && isph_is_driven(s) && !s->on.soil && !s->on.open_sides && !s->on.wells;
}

/* K of all particles, in place of the moments that s->linear holds, once surfaces are known. */
void isph_linear_find(struct isph *s);

/* gradient = K gradient */
static inline void isph_linear_correct(const struct isph *s, size_t i, double gradient[3]) {
  double k[6];
  for (int n = 0; n < 6; n++) k[n] = (double)s->linear[i][n];
  symmetric_times(k, gradient, gradient);
}

#endif
