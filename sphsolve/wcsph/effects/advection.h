/* Advection through Eulerian particles, which stay on their lattice points:
 *
 * dv_a/dt = ... - (v_a . grad) v_a, (v_a . grad) v_a = sum_b V (v_a . grad_a W) (v_b - v_a) (Lind,
 * Stansby 2016; Nasar et al. 2019)
 *
 * The sum is over fluid only: nothing is advected into a wall. On the lattice it is a central
 * difference, which is more accurate than the sum over equally many moving particles, but stable
 * only if viscosity smooths differences between neighbouring points, i.e. at a small cell Reynolds
 * number u dx/nu. Sands with pores two points wide are stable at u dx/nu = 9 and unstable at 20;
 * cylinders at 13 have an error of 1.5 % (moving particles 11 %). Eulerian particles are used up to
 * 5. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_ADVECTION_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_ADVECTION_H

#include <stdio.h>

#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/scales.h"

/* The pair function is shifting_carry (shifting.h): a particle at rest in the flow is one shifted
 * by u = -v. */

static inline bool wcsph_advection_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  return wcsph_eulerian(context, why);
}

#endif

EFFECT(advection, .model = "particles stay on their lattice points, the fluid flows past",
       .citation = "Lind, Stansby 2016; Nasar et al. 2019", .wanted = wcsph_advection_wanted,
       .operations = 4, .budget = 1u << BUDGET_ADVECTION)
