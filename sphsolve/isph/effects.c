#include "sphsolve/output/conservation.h"
#include "sphsolve/isph/method.h"

#define EFFECTS isph_effects
#define EFFECTS_REGISTRY "sphsolve/isph/effects/registry.def"
#include "sphsolve/plan/effect_list.h"
