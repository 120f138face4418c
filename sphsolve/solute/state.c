#include "sphsolve/solute/state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/output_guard.h"
#include "common/provenance.h"
#include "common/ranks.h"
#include "sphsolve/output/checkpoint_file.h"
#include "sphsolve/scene/scene_compare.h"

#define GROUP "/solute_state"

/* Parts of the state that are stored as in memory, with their paths in the file. */
struct block {
  const char *path;
  void *data;
  size_t bytes;
};

enum { BLOCKS = 4 };
static void blocks_of(struct solute_state *s, struct block block[BLOCKS]) {
  block[0] = (struct block){GROUP "/solved", s->solved, sizeof s->solved};
  block[1] = (struct block){GROUP "/walked", s->walked, sizeof s->walked};
  block[2] = (struct block){GROUP "/record", s->record, sizeof s->record};
  block[3] = (struct block){GROUP "/counts", s->solved_count,
                            sizeof s->solved_count + sizeof s->walked_count};
}

static void track_path(char path[64], int lattice, int peclet) {
  snprintf(path, 64, GROUP "/track-%d-%d", lattice, peclet);
}

#define FRAME_WORDS (WALK_FRAMES * sizeof(struct walk_frame) / sizeof(uint32_t))

static void frame_path(char path[64], int lattice, int peclet) {
  snprintf(path, 64, GROUP "/frames-%d-%d", lattice, peclet);
}

/* Saves tracks and histograms of the completed walks. */
static enum status save_tracks(const struct solute_state *s, struct h5_file *file) {
  enum status status = STATUS_OK;
  for (int l = 0; l < SOLUTE_LATTICES; l++)
    for (int i = 0; i < s->walked_count[l]; i++) {
      const struct walk_record *r = &s->record[l][i];
      const size_t dims[1] = {(size_t)WALK_TRACK * WALK_TRACKED * 3};
      char path[64];
      track_path(path, l, i);
      TRY(h5_write(file, path, H5_F32, 1, dims, r->track, true));
      const size_t words = FRAME_WORDS;
      frame_path(path, l, i);
      TRY(h5_write(file, path, H5_U32, 1, &words, r->frame, true));
    }
cleanup:
  return status;
}

static enum status load_tracks(struct solute_state *s) {
  enum status status = STATUS_OK;
  for (int l = 0; l < SOLUTE_LATTICES; l++)
    for (int i = 0; i < s->walked_count[l]; i++) {
      struct walk_record *r = &s->record[l][i];
      size_t count;
      char path[64];
      track_path(path, l, i);
      TRY(h5_read(s->from, path, H5_F32, 1, &count, &r->track));
      if (count != (size_t)WALK_TRACK * WALK_TRACKED * 3)
        TRY_FAIL(STATUS_INPUT, "%s: %s has another size", h5_path(s->from), path);
      uint32_t *frame = NULL;
      frame_path(path, l, i);
      TRY(h5_read(s->from, path, H5_U32, 1, &count, &frame));
      r->frame = (struct walk_frame *)(void *)frame;
      if (count != FRAME_WORDS || r->frames < 0 || r->frames > WALK_FRAMES)
        TRY_FAIL(STATUS_INPUT, "%s: %s has another size", h5_path(s->from), path);
    }
cleanup:
  return status;
}

static enum status compare_scenes(const struct solute_state *s) {
  enum status status = STATUS_OK;
  char *then = NULL, *now = NULL;
  uint64_t hash;
  TRY(h5_read_text(s->from, GROUP "/settings", &then));
  TRY(scene_describe(s->scene, &now));
  TRY(scene_compare(then, now, h5_path(s->from)));
  TRY(h5_read_attribute(s->from, GROUP, "flow_hash", H5_U64, 1, &hash));
  if (hash != s->flow_hash)
    TRY_FAIL(STATUS_INPUT,
             "%s: belongs to another flow than %s as it is now; leave out --resume to start anew",
             h5_path(s->from), s->scene->flow_path);
cleanup:
  memory_free(&then);
  free(now);
  return status;
}

static enum status load(struct solute_state *s) {
  enum status status = STATUS_OK;
  struct block block[BLOCKS];
  uint32_t *data = NULL;
  double spent;
  if (!h5_exists(s->from, GROUP))
    TRY_FAIL(STATUS_INPUT, "%s: is no checkpoint of method solute; leave out --resume",
             h5_path(s->from));
  TRY(compare_scenes(s));
  blocks_of(s, block);
  for (int b = 0; b < BLOCKS; b++) {
    size_t words;
    TRY(h5_read(s->from, block[b].path, H5_U32, 1, &words, &data));
    if (words * sizeof *data != block[b].bytes)
      TRY_FAIL(STATUS_INPUT, "%s: was written by another version; leave out --resume to start anew",
               h5_path(s->from));
    memcpy(block[b].data, data, block[b].bytes);
    memory_free(&data);
  }
  for (int l = 0; l < SOLUTE_LATTICES; l++)
    for (int i = 0; i < SOLUTE_PECLET_MAX; i++) {
      s->record[l][i].track = NULL; /* pointer of the process that saved it */
      s->record[l][i].frame = NULL;
    }
  for (int l = 0; l < SOLUTE_LATTICES; l++)
    if (s->solved_count[l] < 0 || s->solved_count[l] > SOLUTE_PECLET_MAX + 1 ||
        s->walked_count[l] < 0 || s->walked_count[l] > SOLUTE_PECLET_MAX)
      TRY_FAIL(STATUS_INPUT, "%s: is damaged", h5_path(s->from));
  TRY(load_tracks(s));
  TRY(h5_read_attribute(s->from, GROUP, "wall_time", H5_F64, 1, &spent));
  s->started -= spent;
  log_info("--resume: goes on from %s", h5_path(s->from));
cleanup:
  memory_free(&data);
  return status;
}

enum status solute_state_begin(const struct scene *scene, const char *prefix, bool resume,
                               struct solute_state *s) {
  enum status status = STATUS_OK;
  char path[4200];
  memset(s, 0, sizeof *s);
  s->scene = scene, s->prefix = prefix, s->started = s->last = clock_seconds();
  TRY(hash_file(scene->flow_path, &s->flow_hash));
  snprintf(path, sizeof path, "%s.ckpt.hdf", prefix);
  if (!resume) {
    TRY(output_allow(path));
    goto cleanup;
  }
  TRY(checkpoint_open(prefix, &s->from));
  if (s->from != NULL)
    TRY(load(s));
  else
    log_info("no checkpoint %s yet: starting anew", path);
cleanup:
  if (status != STATUS_OK) solute_state_free(s);
  return status;
}

void solute_state_free(struct solute_state *s) {
  for (int l = 0; l < SOLUTE_LATTICES; l++)
    for (int i = 0; i < SOLUTE_PECLET_MAX; i++) walk_record_free(&s->record[l][i]);
  h5_close(s->from);
  s->from = NULL;
}

bool solute_state_due(const struct solute_state *s) {
  if (s->scene == NULL) return false;
  const double interval = s->scene->checkpoint_interval;
  return ranks_any(interrupt_requested() ||
                   (!isnan(interval) && clock_seconds() - s->last >= interval));
}

static enum status save_closure(const struct solute_closure *c, struct h5_file *file) {
  enum status status = STATUS_OK;
  for (int a = 0; a < 3; a++) {
    char path[64];
    snprintf(path, sizeof path, GROUP "/closure-%d", a);
    if (c->b[a] != NULL)
      TRY(h5_write(file, path, H5_F64, 1, &c->solver.cells[0].size, c->b[a], false));
  }
cleanup:
  return status;
}

enum status solute_state_save(struct solute_state *s, const struct solute_closure *closure,
                              struct walk *walk) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  struct block block[BLOCKS];
  char *settled = NULL;
  const double spent = clock_seconds() - s->started;
  TRY(checkpoint_create(s->prefix, &file));
  TRY(h5_make_group(file, GROUP));
  TRY(h5_write_attribute(file, GROUP, "flow_hash", H5_U64, 1, &s->flow_hash));
  TRY(h5_write_attribute(file, GROUP, "wall_time", H5_F64, 1, &spent));
  TRY(scene_describe(s->scene, &settled));
  TRY(h5_write_text(file, GROUP "/settings", settled));
  blocks_of(s, block);
  for (int b = 0; b < BLOCKS; b++) {
    const size_t words = block[b].bytes / sizeof(uint32_t);
    TRY(h5_write(file, block[b].path, H5_U32, 1, &words, block[b].data, true));
  }
  TRY(save_tracks(s, file));
  if (closure != NULL) TRY(save_closure(closure, file));
  if (walk != NULL) TRY(walk_save(file, GROUP "/walk", walk));
  status = checkpoint_commit(s->prefix, file);
  file = NULL;
  if (status != STATUS_OK) goto cleanup;
  s->last = clock_seconds();
  if (ranks_any(interrupt_requested()))
    TRY_FAIL(STATUS_INTERRUPTED, "interrupted; --resume goes on from %s.ckpt.hdf", s->prefix);
cleanup:
  free(settled);
  h5_close(file);
  return status;
}

enum status solute_state_restore_closure(struct solute_state *s, struct solute_closure *c) {
  enum status status = STATUS_OK;
  double *b = NULL;
  if (s->from == NULL) return STATUS_OK;
  for (int a = 0; a < 3; a++) {
    char path[64];
    size_t count;
    snprintf(path, sizeof path, GROUP "/closure-%d", a);
    if (c->b[a] == NULL || !h5_exists(s->from, path)) continue;
    TRY(h5_read(s->from, path, H5_F64, 1, &count, &b));
    if (count != c->solver.cells[0].size)
      TRY_FAIL(STATUS_INPUT, "%s: %s has another size", h5_path(s->from), path);
    memcpy(c->b[a], b, count * sizeof *b);
    memory_free(&b);
  }
  h5_close(s->from);
  s->from = NULL;
cleanup:
  memory_free(&b);
  return status;
}

enum status solute_state_restore_walk(struct solute_state *s, const struct walk_cells *cells,
                                      struct walk *walk, bool *found) {
  enum status status = STATUS_OK;
  *found = s->from != NULL && h5_exists(s->from, GROUP "/walk");
  if (*found) TRY(walk_load(s->from, GROUP "/walk", cells, walk));
  h5_close(s->from);
  s->from = NULL;
cleanup:
  return status;
}
