/* Correction that makes the pressure gradient exact for linear fields in free water (Randles,
 * Libersky 1996, Comput. Methods Appl. Mech. Eng. 139; Bonet, Lok 1999, same 180), where a driving
 * force acts and there is neither soil nor window nor well. With the second moment of a
 * neighbourhood, including images and walls,
 *   M = sum V slope r r,
 * which is the identity on the lattice, the gradient is multiplied by
 *   K = (1 - w) M^-1 + w [ 1 + (1/m - 1) (1 - n n) ],
 * where w is the surface weight of the particle, n its surface normal and m the mean of M along the
 * surface. On the surface half of a neighbourhood is missing. In the normal direction a ghost
 * particle closes the gradient (effects/surface.h); along the surface nothing else does, and the
 * outermost row of a wave would be a quarter slower than the wave.
 *
 * The divergence of such water where it strains fast is
 *   div v = -sum V slope (v_i - v_j).D (x_i - x_j),   D = 1 + b (1 - w) (M^-1 - 1),
 *   b = q^2/(q^2 + 1),   q = |v . grad v| / |f|,
 * where f is the driving force. Where water turns up at a wall after an impact (q of 10 and more),
 * rows are squeezed along the wall and give way: M is neither the identity nor steady, and with the
 * plain sum a volume-preserving strain E has the divergence E:M. The pressure that removes it
 * pulses by a quarter of its mean, the more the shorter the steps. But only the plain sum, over all
 * the water, equals the flux through its boundary, so that it is used in all other water: with D =
 * M^-1, but for the surface row, an inviscid wave (q of .05 at most) grows by 2 % a period, and the
 * pressure in the last void of a box, as it closes, is ten times as high. With D = M^-1 in that row
 * too a low wave neither grows nor decays, but a steep one on 40 rows grows by .7 % a period, and
 * the wave is slower by k r0/4, as the surface then moves by what its particles do half a particle
 * below it. */
#ifndef TOSUI_SPHSOLVE_ISPH_LINEAR_H
#define TOSUI_SPHSOLVE_ISPH_LINEAR_H

#include <stdbool.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/isph/symmetric.h"

/* Whether the scene is of such free water. */
static inline bool isph_is_free_water(const struct isph *s) {
  return s->on.surface && isph_is_driven(s) && !s->on.soil && !s->on.open_sides && !s->on.wells;
}

/* Replaces the moments in s->linear by K, for all particles; surfaces have to be known. */
void isph_linear_find(struct isph *s);

/* Finds D of particle i; false if it is the identity, and then d is not set. */
bool isph_strain_turn(const struct isph *s, size_t i, double d[6]);

/* gradient = K gradient */
static inline void isph_linear_correct(const struct isph *s, size_t i, double gradient[3]) {
  double k[6];
  for (int n = 0; n < 6; n++) k[n] = (double)s->linear[i][n];
  symmetric_times(k, gradient, gradient);
}

#endif
