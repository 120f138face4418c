/* Grains as frozen fluid particles (Saomoto et al. 2006): the loops treat wall particles as fluid
 * at rest. Every gap becomes one spacing too wide. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_WALL_FROZEN_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_WALL_FROZEN_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/wcsph/scales.h"

static inline bool wcsph_wall_frozen_wanted(const struct effect_context *context,
                                            char why[EFFECT_WHY]) {
  return wcsph_wall_wanted(context, WALL_FROZEN, why);
}

#endif

EFFECT(wall_frozen, .model = "grains are frozen fluid particles; every gap is one spacing too wide",
       .citation = "Saomoto et al. 2006", .wanted = wcsph_wall_frozen_wanted)
