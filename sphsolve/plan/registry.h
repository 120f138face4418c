/* The registry: all effects in the order of evaluation, from effects.def. */
#ifndef TOSUI_SPHSOLVE_PLAN_REGISTRY_H
#define TOSUI_SPHSOLVE_PLAN_REGISTRY_H

#include "sphsolve/plan/effect.h"

extern const struct effect *const effects_all[];
extern const size_t effects_count;

#endif
