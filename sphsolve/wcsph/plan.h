/* From a plan to the numbers the engine takes. */
#ifndef TOSUI_SPHSOLVE_WCSPH_PLAN_H
#define TOSUI_SPHSOLVE_WCSPH_PLAN_H

#include "sphsolve/wcsph/engine/engine.h"
#include "sphsolve/wcsph/scales.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/plan/ranks_forecast.h"

extern const struct effect *const wcsph_effects[]; /* effects/registry.def */
enum status wcsph_scales(struct plan *plan);
enum status wcsph_cost(struct plan *plan, int threads);
void wcsph_ranks_cost(const struct plan *plan, int ranks, int threads, struct ranks_cost *cost);

/* The treatment of walls that the pair loops take for a scene. */
enum pass_wall wcsph_pass_wall(const struct effect_context *context);
/* `region_velocity` [scene->region_count][3] is the caller's and must outlive the engine. */
enum status wcsph_settings(const struct scene *scene, const struct plan *plan,
                           double (*region_velocity)[3], struct engine_settings *settings);
/* Mean width of the pores in spacings: twice the fluid's volume over the wall's surface (faces of
 * voxels overstate it by about 3/2 where walls are not planes). INFINITY without walls. */
double wcsph_gap(const struct lattice *lattice);

#endif
