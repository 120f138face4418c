/* Artificial viscosity: a lower bound of the eddy viscosity of water with a surface under gravity:
 *   nu + max(nu_T, nu_c),   nu_c = 0.08 r0 sqrt(|f| r0),  r0 the particle spacing.
 * The projection is approximate: the divergence that it leaves (a few 1e-5 of the energy per
 * second) drives eddies of some spacings. In a tank at rest, 20 cm deep and 20 particles high, they
 * move at 3 to 9 mm/s without the bound, at 2 to 7 mm/s with a quarter or half of it, and below .1
 * mm/s with it. nu_c decreases as r0^(3/2); a wave of length L loses 2 nu_c (2 pi / L)^2 of its
 * height per second. Where free water is calm (isph/calm.h), biharmonic viscosity
 * (isph/biharmonic.h) replaces it: the bound there is (1 - calm) nu_c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_ARTIFICIAL_VISCOSITY_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_ARTIFICIAL_VISCOSITY_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/constants.h"

static inline double artificial_viscosity(const struct isph *s) {
  const double *f = s->force;
  double strength = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  return ARTIFICIAL_VISCOSITY * s->spacing * sqrt(strength * s->spacing);
}

/* The lower bound at particle i, m^2/s. */
static inline double isph_artificial_viscosity_at(const struct isph *s, size_t i) {
  return s->calm != NULL ? (1 - s->calm[i]) * s->artificial_viscosity : s->artificial_viscosity;
}

static inline bool isph_artificial_viscosity_wanted(const struct effect_context *context,
                                                    char why[EFFECT_WHY]) {
  bool on = context->has_surface && context->driving > 0;
  snprintf(why, EFFECT_WHY,
           on ? "a surface under gravity is never quite still without"
              : "no surface under gravity");
  return on;
}

#endif

EFFECT(isph_artificial_viscosity,
       .model = "a floor under the eddy viscosity, 0.08 r0 sqrt(|f| r0); "
                "biharmonic in calm free water",
       .citation = "docs/physics/isph.md", .wanted = isph_artificial_viscosity_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, artificial_viscosity),
       .budget = 1u << BUDGET_ARTIFICIAL_VISCOSITY)
