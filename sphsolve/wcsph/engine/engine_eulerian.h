/* The part of the engine that knows of Eulerian particles (pairs_eulerian.h). */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_EULERIAN_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_EULERIAN_H

#include "sphsolve/wcsph/engine/engine.h"

/* Before the sums over walls: the distance of each particle to its wall, m. */
void engine_eulerian_begin(struct engine *engine);
/* After the sums over walls and fluid: what they make of each particle's equations. */
void engine_eulerian_finish(struct engine *engine);
/* v_next, the old velocity until now: that whose flux the continuity equation balances. */
void engine_eulerian_flux(struct engine *engine);

#endif
