/* The parts of the descriptor of method isph. */
#ifndef TOSUI_SPHSOLVE_ISPH_METHOD_H
#define TOSUI_SPHSOLVE_ISPH_METHOD_H

#include "sphsolve/isph/state.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"

extern const struct effect *const isph_effects[]; /* effects/registry.def */
/* Sets kernel, support and smoothing length (m) of the plan. */
enum status isph_scales(struct plan *plan);
/* Whether the scene has axis a: 2-D scenes have no y. */
static inline bool isph_scene_uses_axis(const struct effect_context *context, int a) {
  return context->lattice->dimensions == 3 || a != 1;
}
/* isph/refuse.c: returns an error for scenes whose results could not be right. */
enum status isph_refuse(const struct effect_context *context);
/* Sets the expected memory, steps, time and error of k in the plan; fails for scenes that are
 * refused. */
enum status isph_cost(struct plan *plan, int threads);

#endif
