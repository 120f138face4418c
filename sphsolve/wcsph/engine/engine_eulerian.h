/* Parts of the engine for Eulerian particles (pairs_eulerian.h). */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_EULERIAN_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_EULERIAN_H

#include "sphsolve/wcsph/engine/engine.h"

/* Before the sums over walls: sets the distance of each particle to its wall, m. */
void engine_eulerian_begin(struct engine *engine);
/* After the sums over walls and fluid: computes the site terms of each particle. */
void engine_eulerian_finish(struct engine *engine);
/* Sets v_next, which held the old velocity, to the velocity whose flux the continuity equation
 * balances. */
void engine_eulerian_flux(struct engine *engine);

#endif
