#include "sphsolve/output/conservation.h"
#include "sphsolve/wcsph/plan.h"

#define EFFECTS wcsph_effects
#define EFFECTS_REGISTRY "sphsolve/wcsph/effects/registry.def"
#include "sphsolve/plan/effect_list.h"
