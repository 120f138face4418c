/* Anisotropic soil (in beds): its permeability, and with it drag and the mobility in the pressure
 * equation, are tensors. The implementation is in isph/anisotropy.c, of which nothing is called
 * without this effect. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_ANISOTROPY_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_ANISOTROPY_H

#include <stdio.h>

#include "sphsolve/isph/anisotropy.h"
#include "sphsolve/plan/plan.h"

static inline bool isph_anisotropy_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  const bool on = isph_is_anisotropic(context->scene) && context->kinematic_viscosity > 0;
  snprintf(why, EFFECT_WHY,
           on ? "soil with a permeability for each axis"
              : "no soil with a permeability for each axis");
  return on;
}

static inline enum status isph_anisotropy_starts(void *state, double dt) {
  isph_anisotropy_begin(state, dt);
  return STATUS_OK;
}

static inline enum status isph_anisotropy_mobile(void *state, double dt) {
  (void)dt;
  isph_anisotropy_pairs(state);
  return STATUS_OK;
}

#endif

EFFECT(isph_anisotropy, .model = "drag and mobility are tensors; pairs weigh by exp(n.S.n)",
       .citation = "Jaynes 1957; Arroyo, Ortiz 2006", .wanted = isph_anisotropy_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, anisotropy),
       .begin = isph_anisotropy_starts, .mobile = isph_anisotropy_mobile)
