/* Conversion of a plan to the settings of the engine. */
#ifndef TOSUI_SPHSOLVE_WCSPH_PLAN_H
#define TOSUI_SPHSOLVE_WCSPH_PLAN_H

#include "sphsolve/wcsph/engine/engine.h"
#include "sphsolve/wcsph/scales.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"

extern const struct effect *const wcsph_effects[]; /* effects/registry.def */
enum status wcsph_scales(struct plan *plan);
enum status wcsph_cost(struct plan *plan, int threads);

/* Wall treatment of the pair loops for a scene. */
enum pass_wall wcsph_pass_wall(const struct effect_context *context);
/* `region_velocity` [scene->region_count][3] is owned by the caller and must outlive the engine. */
enum status wcsph_settings(const struct scene *scene, const struct plan *plan,
                           double (*region_velocity)[3], struct engine_settings *settings);
/* Mean pore width in spacings: twice the fluid volume / wall surface (voxel faces overestimate a
 * curved surface by about 3/2). INFINITY without walls. */
double wcsph_gap(const struct lattice *lattice);

#endif
