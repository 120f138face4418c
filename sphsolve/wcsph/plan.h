/* From a plan to the numbers the engine takes. */
#ifndef TOSUI_SPHSOLVE_WCSPH_PLAN_H
#define TOSUI_SPHSOLVE_WCSPH_PLAN_H

#include "sphsolve/wcsph/engine/engine.h"
#include "sphsolve/plan/method.h"

/* Stabilisation of the pressure beside walls, dx^2/nu (effects/pressure_diffusion.h). Less locks
 * pores one or two particles wide (k of a sand -20 % at 0), more lets pressure through thin walls
 * (+30 % at .02). */
#define WCSPH_TAU 0.005
/* The same as method stokes where particles stay: what it does to smooth pressures is taken back.
 */
#define WCSPH_TAU_SITES 0.05

enum status wcsph_scales(struct plan *plan);
enum status wcsph_cost(struct plan *plan, int threads);
void wcsph_ranks_cost(const struct plan *plan, int ranks, int threads, struct ranks_cost *cost);

/* Particles stay on their sites (effects/advection.h); `why` may be NULL. */
bool wcsph_stays(const struct effect_context *context, char why[EFFECT_WHY]);
enum pass_wall wcsph_pass_wall(const struct effect_context *context);
/* Sound that the time step has to follow, m/s: gradients corrected along narrow pores let it run
 * faster. Among spheres at random a run is quiet at the limit with twice the speed, and noisy
 * at 1.5 of it. */
double wcsph_sound_for_dt(const struct effect_context *context);
/* Of pressure, m^2/s (effects/pressure_diffusion.h): beside walls tau c^2; 0 with frozen walls. */
double wcsph_diffusion(const struct effect_context *context);
/* `region_velocity` [scene->region_count][3] is the caller's and must outlive the engine. */
void wcsph_settings(const struct scene *scene, const struct plan *plan,
                    double (*region_velocity)[3], struct engine_settings *settings);
/* Mean width of the pores in spacings: twice the fluid's volume over the wall's surface (faces of
 * voxels overstate it by about 3/2 where walls are not planes). INFINITY without walls. */
double wcsph_gap(const struct lattice *lattice);

#endif
