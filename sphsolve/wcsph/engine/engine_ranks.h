/* The part of the engine that knows of other ranks. In a build without MPI none of it is called. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_RANKS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_RANKS_H

#include "sphsolve/wcsph/engine/engine.h"

#define BLOCK PASS_BLOCK
/* Cuts lie at multiples of so many clusters: blocks of sums belong to one rank. */
#define PARTITION_UNIT 256

static inline bool engine_is_distributed(const struct engine *engine) {
  return RANKS && engine->ranks.fluid.partition != NULL;
}
/* Own particles alone stay. */
enum status engine_drop_ghosts(struct engine *engine);
/* Collective: as particles_sort, and partitions anew. */
enum status engine_order(struct engine *engine);
/* Collective: the walls within `range` of fluid, ordered and partitioned. */
enum status engine_order_walls(struct engine *engine, double range);
/* Collective, where boxes of own clusters are known: makes the lists, finds the ghosts, and which
 * blocks of rows read none. */
enum status engine_list_distributed(struct engine *engine, double range, double widest);
/* Collective: sends what the step has just made to the ranks that read it. */
enum engine_sent {
  SENT_MOTION,  /* place and velocity */
  SENT_DENSITY, /* of frozen walls' fluid */
  SENT_WALL,
  SENT_PLACE, /* and pressure */
  SENT_FLUX,  /* Eulerian, in v_next */
  SENT_STATE, /* Eulerian: velocity and pressure */
  SENT_ALL,
  SENT_WALL_ALL
};
void engine_send(struct engine *engine, enum engine_sent what);
/* Blocks of rows: those that read no ghost while ghosts are on their way, then the others. */
void engine_run_distributed(struct engine *engine, pass_function *function, bool wall);

#endif
