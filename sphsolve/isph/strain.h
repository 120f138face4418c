/* The divergence of free water (isph/linear.h) that strains fast:
 *   div v = -sum V slope (v_i - v_j).D (x_i - x_j),   D = 1 + b (1 - w) (M^-1 - 1),
 *   b = q^2/(q^2 + 1),   q = |v . grad v| / |f|,
 * M the moment of a neighbourhood, by whose inverse the sum is exact for linear fields (Randles,
 * Libersky 1996, Comput. Methods Appl. Mech. Eng. 139), w how far the particle is on the surface, f
 * the driving force. Where water turns up at a wall that it has struck (q of 10 and more) rows are
 * squeezed along it and give way: M is neither 1 nor steady, and a strain E that keeps the volume
 * has the divergence E:M by the plain sum. The pressure that takes it out pulses by a quarter of
 * its mean, the more the shorter the steps. Only the plain sum over all water is what goes through
 * its outside, so that all other water has it: with D = M^-1 a wave (q of .05 at most) without any
 * viscosity grows by 2 % a period, and the pressure in the last void of a box, as it closes, is ten
 * times as high. */
#ifndef TOSUI_SPHSOLVE_ISPH_STRAIN_H
#define TOSUI_SPHSOLVE_ISPH_STRAIN_H

#include <stdbool.h>

#include "sphsolve/isph/state.h"

/* D of particle i; false where it is 1, and not set. */
bool isph_strain_turn(const struct isph *s, size_t i, double d[6]);

#endif
