/* What flows past particles that stay on their lattice points: SPH in Euler's description,
 *   dv_a/dt = ... - (v_a . grad) v_a,
 *   (v_a . grad) v_a = sum_b V (v_a . grad_a W) (v_b - v_a)
 *                                        (Lind, Stansby 2016; Nasar et al. 2019)
 * over fluid: nothing crosses to a wall. Particles out of order, and shifting, need more of them
 * for the same accuracy; but central differences between lattice points follow only what viscosity
 * smooths from one to the next. Sands with pores two points wide run up to a largest velocity
 * expected of u dx/nu = 9, not at 20; cylinders at 13 have 1.5 % of error (moving particles 11 %).
 * So: up to 5. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_ADVECTION_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_ADVECTION_H

#include <stdio.h>

#include "sphsolve/wcsph/scales.h"

#define ADVECTION_CELL_REYNOLDS 5.0

/* Its pair is shifting_carry (shifting.h): resting is a shift by u = -v. */

static inline bool wcsph_advection_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  return wcsph_eulerian(context, why);
}

#endif

EFFECT(advection, .model = "particles stay on their lattice points, the fluid flows past",
       .citation = "Lind, Stansby 2016; Nasar et al. 2019", .wanted = wcsph_advection_wanted,
       .operations = 4, .budget = 1u << BUDGET_ADVECTION)
