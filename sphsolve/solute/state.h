/* What a run of method solute has found so far, and its checkpoints: a run that goes on from one
 * is, bit for bit, the run that never ended. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_STATE_H
#define TOSUI_SPHSOLVE_SOLUTE_STATE_H

#include <stdbool.h>

#include "common/hdf5_file.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/solute/closure.h"
#include "sphsolve/solute/result.h"
#include "sphsolve/solute/sample_size.h"

/* The flow's own cells, those taken two by two by two, and those once more (for the order of the
 * closure problem alone). */
enum { SOLUTE_FINE, SOLUTE_COARSE, SOLUTE_COARSEST, SOLUTE_LATTICES };

/* What one lattice gave for one Peclet number. */
struct solute_solved {
  struct solute_dispersion value;
  struct solute_sample sample; /* of the flow's own cells alone */
  double seconds;
};

struct solute_state {
  const struct scene *scene; /* NULL: nothing is ever saved */
  const char *prefix;
  uint64_t flow_hash;
  double started, last; /* clock_seconds: less what was spent before it was gone on; when saved */
  /* By lattice, of those in the order of the Peclet numbers so many; the closure problem has first
   * that without flow. */
  int solved_count[SOLUTE_LATTICES], walked_count[SOLUTE_LATTICES];
  struct solute_solved solved[SOLUTE_LATTICES][SOLUTE_PECLET_MAX + 1];
  struct solute_walked walked[SOLUTE_LATTICES][SOLUTE_PECLET_MAX];
  struct walk_record record[SOLUTE_LATTICES][SOLUTE_PECLET_MAX];
  struct h5_file *from; /* what is gone on from; NULL: nothing, or all of it is read */
};

/* Refuses to write over checkpoints of others. With `resume` from PREFIX.ckpt.hdf where there is
 * one of this scene and flow. All are collective. Free with solute_state_free. */
enum status solute_state_begin(const struct scene *scene, const char *prefix, bool resume,
                               struct solute_state *state);
void solute_state_free(struct solute_state *state);

/* Whether the interval is over or an end is asked for. */
bool solute_state_due(const struct solute_state *state);
/* With what is at hand, or NULL. Fails (STATUS_INTERRUPTED) when an end is asked for. */
enum status solute_state_save(struct solute_state *state, const struct solute_closure *closure,
                              struct walk *walk);
/* Takes up what was at hand when it was saved, if anything was: the closure variables; the walk,
 * else *found is false. */
enum status solute_state_take_closure(struct solute_state *state, struct solute_closure *closure);
enum status solute_state_take_walk(struct solute_state *state, const struct walk_cells *cells,
                                   struct walk *walk, bool *found);

#endif
