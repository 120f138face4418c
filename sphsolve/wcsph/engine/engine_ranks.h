/* Parts of the engine for several ranks. A build without MPI calls none of them. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_RANKS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_RANKS_H

#include "sphsolve/wcsph/engine/engine.h"

#define BLOCK PASS_BLOCK
/* Partitions start at multiples of this number of clusters, so that blocks of sums belong to one
 * rank. */
#define PARTITION_UNIT 256

static inline bool engine_is_distributed(const struct engine *engine) {
  return RANKS && engine->ranks.fluid.partition != NULL;
}
/* Removes all ghosts. */
enum status engine_drop_ghosts(struct engine *engine);
/* Collective: as particles_sort, with a new partition. */
enum status engine_order(struct engine *engine);
/* Collective: makes the walls within `range` of fluid, ordered and partitioned. */
enum status engine_order_walls(struct engine *engine, double range);
/* Collective, once the boxes of own clusters are known: makes the lists, finds the ghosts, and the
 * blocks of rows that read none. */
enum status engine_list_distributed(struct engine *engine, double range, double widest);
/* Collective: sends new data of the step to the ranks that read it. */
enum engine_sent {
  SENT_MOTION,  /* position and velocity */
  SENT_DENSITY, /* density of fluid with frozen walls */
  SENT_WALL,
  SENT_PLACE, /* position and pressure */
  SENT_FLUX,  /* Eulerian, in v_next */
  SENT_STATE, /* Eulerian: velocity and pressure */
  SENT_ALL,
  SENT_WALL_ALL
};
void engine_send(struct engine *engine, enum engine_sent what);
/* Runs a pass over blocks of rows: those without ghosts during the transfer of ghosts, then the
 * others. */
void engine_run_distributed(struct engine *engine, pass_function *function, bool wall);

#endif
