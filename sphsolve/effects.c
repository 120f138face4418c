#include "sphsolve/effects.h"

#include "sphsolve/effects/isph_effects.h"
#include "sphsolve/effects/stokes_force.h"
#include "sphsolve/effects/stokes_pressure.h"
#include "sphsolve/effects/stokes_stabilisation.h"
#include "sphsolve/effects/stokes_viscosity.h"
#include "sphsolve/effects/stokes_wall_adami.h"
#include "sphsolve/effects/stokes_wall_frozen.h"
#include "sphsolve/effects/stokes_wall_subvoxel.h"
#include "sphsolve/effects/wcsph_effects.h"

const struct effect *const effects_all[] = {
#define EFFECT(name) &effect_##name,
#include "sphsolve/effects.def"
#undef EFFECT
    NULL};
const size_t effects_count = sizeof effects_all / sizeof *effects_all - 1;
