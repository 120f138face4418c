/* With velocity and pressure on the same sites, checkerboard pressures are not controlled. The term
 * gamma (L + div G) p is added to the continuity equation; L: the viscous stencil over pore pairs,
 * G: the gradient. The two Laplacians cancel for smooth pressures, which removes the error of L
 * alone (Brezzi, Pitkaeranta 1984), as in Rhie, Chow (1983); their difference is never negative
 * (Cauchy, Schwarz). */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_STABILISATION_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_STABILISATION_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/stokes/constants.h"

static inline bool stokes_stabilisation_wanted(const struct effect_context *context,
                                               char why[EFFECT_WHY]) {
  (void)context;
  snprintf(why, EFFECT_WHY, "gamma = %g spacing^2/nu against checkerboard pressures",
           STOKES_STABILISATION);
  return true;
}

#endif

EFFECT(stokes_stabilisation,
       .model = "difference of two pressure Laplacians in the continuity equation",
       .citation = "Rhie, Chow 1983; Brezzi, Pitkaeranta 1984",
       .wanted = stokes_stabilisation_wanted)
