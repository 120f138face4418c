#include "sphsolve/plan/registry.h"

#include "sphsolve/isph/effects/effects.h"
#include "sphsolve/stokes/effects/force.h"
#include "sphsolve/stokes/effects/pressure.h"
#include "sphsolve/stokes/effects/stabilisation.h"
#include "sphsolve/stokes/effects/viscosity.h"
#include "sphsolve/stokes/effects/wall_adami.h"
#include "sphsolve/stokes/effects/wall_frozen.h"
#include "sphsolve/stokes/effects/wall_subvoxel.h"
#include "sphsolve/wcsph/effects/effects.h"

const struct effect *const effects_all[] = {
#define EFFECT(name) &effect_##name,
#include "sphsolve/plan/registry.def"
#undef EFFECT
    NULL};
const size_t effects_count = sizeof effects_all / sizeof *effects_all - 1;
