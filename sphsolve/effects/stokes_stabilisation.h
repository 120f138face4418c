/* Velocity and pressure on the same sites leave checkerboard pressures free. The continuity
 * equation gets tau L p, L the viscous stencil over pore pairs (Brezzi, Pitkaeranta 1984). */
#ifndef TOSUI_SPHSOLVE_EFFECTS_STOKES_STABILISATION_H
#define TOSUI_SPHSOLVE_EFFECTS_STOKES_STABILISATION_H

#include <stdio.h>

#include "sphsolve/plan.h"

/* In spacing^2 / nu: its error falls as spacing^2. */
#define STOKES_TAU 0.02

static inline bool stokes_stabilisation_wanted(const struct effect_context *context,
                                               char why[EFFECT_WHY]) {
  (void)context;
  snprintf(why, EFFECT_WHY, "tau = %g spacing^2/nu against checkerboard pressures", STOKES_TAU);
  return true;
}

static const struct effect effect_stokes_stabilisation = {
    .name = "stokes_stabilisation",
    .model = "pressure Laplacian in the continuity equation",
    .citation = "Brezzi, Pitkaeranta 1984",
    .methods = METHOD_BIT_STOKES,
    .reads = FIELD_BIT(PRESSURE),
    .writes = FIELD_BIT(PRESSURE),
    .wanted = stokes_stabilisation_wanted,
};

#endif
