#include "sphsolve/richards/method.h"

#define EFFECTS richards_effects
#define EFFECTS_REGISTRY "sphsolve/richards/effects/registry.def"
#include "sphsolve/plan/effect_list.h"
