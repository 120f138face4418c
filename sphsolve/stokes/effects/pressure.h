/* Pressure gradient and velocity divergence as a pair of transposes, V = rho = 1:
 * (G p)_a = sum over pore sites of (p_b - p_a) grad W_ab, div = -G^T, so that pressure does no
 * work on a solenoidal flow. The pressure of a wall site is that of its fluid neighbour; G^T then
 * mirrors the velocity. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_PRESSURE_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_PRESSURE_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

/* Factor of the vector from a to b in grad W_ab. */
static inline double stokes_pressure_pair(double r, double dw) {
  return -dw / r;
}

static inline bool stokes_pressure_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  (void)context;
  snprintf(why, EFFECT_WHY, "keeps the steady flow free of divergence");
  return true;
}

#endif

EFFECT(stokes_pressure, .model = "gradient in difference form and its transpose as divergence",
       .citation = "Cummins, Rudman 1999 (projection); difference form: Monaghan 2005, eq. 2.23",
       .wanted = stokes_pressure_wanted)
