/* From a plan to the numbers the engine takes. */
#ifndef TOSUI_METHODS_WCSPH_PLAN_H
#define TOSUI_METHODS_WCSPH_PLAN_H

#include "sphsolve/engine/engine.h"
#include "sphsolve/plan.h"

/* `region_velocity` [scene->region_count][3] is the caller's and must outlive the engine. */
void wcsph_settings(const struct scene *scene, const struct plan *plan,
                    double (*region_velocity)[3], struct engine_settings *settings);
/* Mean width of the pores in spacings: twice the fluid's volume over the wall's surface (faces of
 * voxels overstate it by about 3/2 where walls are not planes). INFINITY without walls. */
double wcsph_gap(const struct lattice *lattice);

#endif
