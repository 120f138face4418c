#include "sphsolve/output/conservation.h"
#include "sphsolve/stokes/method.h"

#define EFFECTS stokes_effects
#define EFFECTS_REGISTRY "sphsolve/stokes/effects/registry.def"
#include "sphsolve/plan/effect_list.h"
