#include "sphsolve/effects.h"

const struct effect *const effects_all[] = {
#define EFFECT(name) &effect_##name,
#include "sphsolve/effects.def"
#undef EFFECT
    NULL};
const size_t effects_count = sizeof effects_all / sizeof *effects_all - 1;
