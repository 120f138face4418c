/* Drag of the soil on the water, implicit (M15 eqs. 8, 9, 19; Akbari 2014):
 *
 *   (C_r/eps) Dv_D/Dt = G (f - grad P/rho) ... - a v_D - b |v_D| v_D,
 *
 * with G = 1 (Akbari) or 1/eps (M15), linearised about v^n by Newton's method,
 *
 *   |v| v -> 2 |v^n| v - |v^n| v^n,
 *
 * so that with T = eps G dt / C_r
 *
 *   v* = B [ v^n + T ( ... + b/G |v^n| v^n ) ],   B = 1 / (1 + T (a + 2 b |v^n|) / G).
 *
 * The same B is part of the mobility k in the pressure equation, hence of its matrix and of the
 * corrector. v is relative to the soil's own motion, eps v_soil. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_DRAG_LINEAR_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_DRAG_LINEAR_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/effects/porosity.h"

static inline double drag_factor(double t, double a, double b, double speed) {
  return 1 / (1 + t * (a + 2 * b * speed));
}

static inline double isph_linear_of(const struct region *region) {
  return region->alpha;
}

static inline bool isph_linear_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool on = isph_any_soil(context->scene, isph_linear_of) && context->kinematic_viscosity > 0;
  snprintf(why, EFFECT_WHY, on ? "soil with alpha > 0" : "no soil with alpha > 0");
  return on;
}

#endif

EFFECT(isph_drag_linear, .model = "a = alpha nu (1-eps)^2 / (eps^3 D50^2), implicit",
       .citation = "Morimoto et al. 2015 (9c)", .wanted = isph_linear_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, drag_linear),
       .budget = 1u << BUDGET_DRAG_LINEAR)
