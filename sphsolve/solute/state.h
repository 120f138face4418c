/* Intermediate results of a run of method solute, and its checkpoints: a resumed run gives bitwise
 * the same results as one without interruption. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_STATE_H
#define TOSUI_SPHSOLVE_SOLUTE_STATE_H

#include <stdbool.h>

#include "common/hdf5_file.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/solute/closure.h"
#include "sphsolve/solute/result.h"
#include "sphsolve/solute/sample_size.h"

/* The flow's own cells, those coarsened once, and those coarsened twice (used only for the order of
 * convergence of the closure problem). */
enum { SOLUTE_FINE, SOLUTE_COARSE, SOLUTE_COARSEST, SOLUTE_LATTICES };

/* Result of the closure problem on one lattice at one Peclet number. */
struct solute_solved {
  struct solute_dispersion value;
  struct solute_sample sample; /* on the flow's own cells only */
  double seconds;
};

struct solute_state {
  const struct scene *scene; /* NULL: no checkpoints */
  const char *prefix;
  uint64_t flow_hash;
  double started, last; /* clock_seconds: start, minus the time spent before resuming; last save */
  /* Number of results on each lattice, in the order of the Peclet numbers; the closure problem
   * begins with the case without flow. */
  int solved_count[SOLUTE_LATTICES], walked_count[SOLUTE_LATTICES];
  struct solute_solved solved[SOLUTE_LATTICES][SOLUTE_PECLET_MAX + 1];
  struct solute_walked walked[SOLUTE_LATTICES][SOLUTE_PECLET_MAX];
  struct walk_record record[SOLUTE_LATTICES][SOLUTE_PECLET_MAX];
  struct h5_file *from; /* checkpoint to resume from; NULL: none, or completely read */
};

/* Starts or, with `resume`, continues from PREFIX.ckpt.hdf if it belongs to this scene and flow.
 * Refuses to overwrite checkpoints of other runs. All functions are collective. Free with
 * solute_state_free. */
enum status solute_state_begin(const struct scene *scene, const char *prefix, bool resume,
                               struct solute_state *state);
void solute_state_free(struct solute_state *state);

/* Whether a checkpoint is due: the interval has passed, or an interrupt was requested. */
bool solute_state_due(const struct solute_state *state);
/* Saves a checkpoint with the closure problem or walk in progress (or NULL). Returns
 * STATUS_INTERRUPTED after an interrupt. */
enum status solute_state_save(struct solute_state *state, const struct solute_closure *closure,
                              struct walk *walk);
/* Restore the closure variables, or the walk, that were in progress when the checkpoint was saved;
 * *found: whether there was a walk. */
enum status solute_state_restore_closure(struct solute_state *state,
                                         struct solute_closure *closure);
enum status solute_state_restore_walk(struct solute_state *state, const struct walk_cells *cells,
                                      struct walk *walk, bool *found);

#endif
