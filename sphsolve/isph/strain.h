/* Divergence of free water (isph/linear.h) that strains fast:
 *   div v = -sum V slope (v_i - v_j).D (x_i - x_j),   D = 1 + b (1 - w) (M^-1 - 1),
 *   b = q^2/(q^2 + 1),   q = |v . grad v| / |f|,
 * where M is the second moment of a neighbourhood, by whose inverse the sum is exact for linear
 * fields (Randles, Libersky 1996, Comput. Methods Appl. Mech. Eng. 139), w the surface weight of
 * the particle, and f the driving force. Where water turns up at a wall after an impact (q of 10
 * and more), rows are squeezed along the wall and give way: M is neither the identity nor steady,
 * and with the plain sum a volume-preserving strain E has the divergence E:M. The pressure that
 * removes it pulses by a quarter of its mean, the more the shorter the steps. But only the plain
 * sum, over all the water, equals the flux through its boundary, so that it is used in all other
 * water: with D = M^-1 an inviscid wave (q of .05 at most) grows by 2 % a period, and the pressure
 * in the last void of a box, as it closes, is ten times as high. */
#ifndef TOSUI_SPHSOLVE_ISPH_STRAIN_H
#define TOSUI_SPHSOLVE_ISPH_STRAIN_H

#include <stdbool.h>

#include "sphsolve/isph/state.h"

/* Finds D of particle i; false if it is the identity, and then d is not set. */
bool isph_strain_turn(const struct isph *s, size_t i, double d[6]);

#endif
