/* Scenes of soil that is full of water and stays so, whose flow is steady at each time
 * (darcy/saturated.h). */
#ifndef TOSUI_SPHSOLVE_DARCY_CONFINED_H
#define TOSUI_SPHSOLVE_DARCY_CONFINED_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "sphsolve/plan/effect.h"

/* Whether it is such a scene; `why`, in any case. */
enum status richards_confined(const struct effect_context *context, bool *confined,
                              char why[EFFECT_WHY]);

#endif
