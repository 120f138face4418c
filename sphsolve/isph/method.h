/* From a plan to the switches of method isph, for those who run its state by hand. */
#ifndef TOSUI_SPHSOLVE_ISPH_METHOD_H
#define TOSUI_SPHSOLVE_ISPH_METHOD_H

#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"

void isph_switches_of(const struct plan *plan, struct isph_switches *on);

#endif
