/* What the descriptor of method isph is made of. */
#ifndef TOSUI_SPHSOLVE_ISPH_METHOD_H
#define TOSUI_SPHSOLVE_ISPH_METHOD_H

#include "sphsolve/isph/state.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/plan/ranks_forecast.h"

extern const struct effect *const isph_effects[]; /* effects/registry.def */
enum status isph_scales(struct plan *plan);
static inline bool isph_scene_uses_axis(const struct effect_context *context, int a) {
  return context->lattice->dimensions == 3 || a != 1;
}
/* isph/refuse.c: an error for scenes that cannot come out right. */
enum status isph_refuse(const struct effect_context *context);
/* What a region gives as a table in the mean up to the end of the run; else `steady`. */
double isph_mean_given(const struct scene *scene, const struct region *region, double steady);
/* isph/refuse_sources.c: its part for wells, drains, rain and absorbing sides. */
enum status isph_refuse_wells(const struct effect_context *context);
enum status isph_refuse_rain(const struct effect_context *context);
enum status isph_refuse_absorbing(const struct effect_context *context);
enum status isph_cost(struct plan *plan, int threads);
void isph_ranks_cost(const struct plan *plan, int ranks, int threads, struct ranks_cost *cost);

/* From a plan to the switches of the state; also for tests, which march it themselves. */
enum status isph_switches_of(const struct plan *plan, struct isph_switches *on);

#endif
