/* What the engine knows of walls before its pair loops run. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_WALLS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_WALLS_H

#include "sphsolve/wcsph/engine/engine.h"

/* The part of a frozen wall's density that never changes, 1: itself and the walls around it, summed
 * over the lattice into particles.wall_base. */
enum status engine_sum_wall_base(struct engine *engine);

/* Distance of each fluid particle to its wall, m, into particles.distance; negative where the field
 * bends (see engine_wall_distance). */
void engine_update_distance(struct engine *engine);

/* Frozen walls, density of their fluid: before rows are summed, and after (of this rank's walls).
 */
void engine_clear_wall_sums(struct engine *engine);
void engine_finish_wall_sums(struct engine *engine);

#endif
