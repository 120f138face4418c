/* From a plan to the numbers the engine takes. */
#ifndef TOSUI_METHODS_WCSPH_PLAN_H
#define TOSUI_METHODS_WCSPH_PLAN_H

#include "sphsolve/engine/engine.h"
#include "sphsolve/plan.h"

/* Stabilisation of the pressure beside walls, dx^2/nu (effects/pressure_diffusion.h). Less locks
 * pores one or two particles wide (k of a sand -20 % at 0), more lets pressure through thin walls
 * (+30 % at .02). */
#define WCSPH_TAU 0.005

/* Of pressure, m^2/s (effects/pressure_diffusion.h): beside walls tau c^2; 0 with frozen walls. */
double wcsph_diffusion(const struct effect_context *context);
/* `region_velocity` [scene->region_count][3] is the caller's and must outlive the engine. */
void wcsph_settings(const struct scene *scene, const struct plan *plan,
                    double (*region_velocity)[3], struct engine_settings *settings);
/* Mean width of the pores in spacings: twice the fluid's volume over the wall's surface (faces of
 * voxels overstate it by about 3/2 where walls are not planes). INFINITY without walls. */
double wcsph_gap(const struct lattice *lattice);

#endif
