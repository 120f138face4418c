/* The parts of the descriptor of method richards. */
#ifndef TOSUI_SPHSOLVE_DARCY_METHOD_H
#define TOSUI_SPHSOLVE_DARCY_METHOD_H

#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"

extern const struct effect *const richards_effects[]; /* effects/registry.def */
/* Sets nothing: the method has no kernel. */
enum status richards_scales(struct plan *plan);
/* Sets the expected memory, steps and time in the plan; fails for scenes that are refused. */
enum status richards_cost(struct plan *plan, int threads);
/* refuse.c: returns an error for scenes that the method cannot solve. */
enum status richards_refuse(const struct effect_context *context);

#endif
