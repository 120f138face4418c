/* Data of walls that the pair loops need; parts of the engine for Eulerian particles
 * (pairs_eulerian.h). */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_WALLS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_WALLS_H

#include "sphsolve/wcsph/engine/engine.h"

/* Constant part of the density of frozen walls, from the particle itself and the walls around it,
 * summed over the lattice into particles.wall_base. */
enum status engine_sum_wall_base(struct engine *engine);

/* Sets particles.distance, the distance of each fluid particle to its wall, m; negative where the
 * field is not smooth (see engine_wall_distance). */
void engine_update_distance(struct engine *engine);

/* Fluid part of the density of frozen walls: before rows are summed, and after (for this rank's
 * walls). */
void engine_clear_wall_sums(struct engine *engine);
void engine_finish_wall_sums(struct engine *engine);

/* Before the sums over walls: sets the distance of each particle to its wall, m. */
void engine_eulerian_begin(struct engine *engine);
/* After the sums over walls and fluid: computes the site terms of each particle. */
void engine_eulerian_finish(struct engine *engine);
/* Sets v_next, which held the old velocity, to the velocity whose flux the continuity equation
 * balances. */
void engine_eulerian_flux(struct engine *engine);

#endif
