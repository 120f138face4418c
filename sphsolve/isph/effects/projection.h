/* The projection onto div v = 0. The pressure P, with q = P - rho f.x its part that is not
 * hydrostatic, solves
 *   div (k grad q) = div v*,   v^{n+1} = v* - k grad q,   k = B T / rho_w
 * (Morimoto et al. 2015, eqs. 18-25), a symmetric equation. Its rows are assembled in
 * isph/pressure.c, the corrector is in isph/step.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_PROJECTION_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_PROJECTION_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool isph_always(const struct effect_context *context, char why[EFFECT_WHY]) {
  const struct scene *scene = context->scene;
  snprintf(why, EFFECT_WHY, "method isph; form %s",
           scene->isph.form == FORM_M15 ? "m15 (forces over eps)" : "akbari");
  return true;
}

#endif

EFFECT(isph_projection, .model = "projection onto div v = 0 by a symmetric pressure equation",
       .citation = "Morimoto et al. 2015 (18)-(25), as corrected in docs/physics/isph.md",
       .wanted = isph_always, .budget = 1u << BUDGET_PROJECTION)
