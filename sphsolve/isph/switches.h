/* Which parts of the physics a plan has on. */
#ifndef TOSUI_SPHSOLVE_ISPH_SWITCHES_H
#define TOSUI_SPHSOLVE_ISPH_SWITCHES_H

#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"

enum status isph_switches_of(const struct plan *plan, struct isph_switches *on);

#endif
