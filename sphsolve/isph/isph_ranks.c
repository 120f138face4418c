#include "sphsolve/isph/isph_ranks.h"

#include "common/memory.h"

#define TAG 5

enum status isph_share_out(struct isph *s) {
  enum status status = STATUS_OK;
  s->share.tag = TAG;
  s->share.bytes_most = sizeof(double[6]);
  if (s->chunk_cut == NULL)
    TRY(memory_allocate(&s->chunk_cut, (size_t)ranks_count() + 1, sizeof *s->chunk_cut, "shares"));
  TRY(ghosts_cut(&s->share, s->count, CHUNK, s->pairs_now));
  for (int r = 0; isph_is_shared(s) && r <= ranks_count(); r++)
    s->chunk_cut[r] = (s->share.cut[r] + CHUNK - 1) / CHUNK;
cleanup:
  return status;
}

enum status isph_find_ghosts(struct isph *s) {
  enum status status = STATUS_OK;
  struct ghosts *g = &s->share;
  if (!isph_is_shared(s)) return STATUS_OK;
  TRY(memory_allocate(&g->wanted, s->count + 1, 1, "ghosts"));
  for (size_t c = 0; c < s->chunk_count; c++) {
    struct isph_chunk *chunk = &s->chunks[c];
    chunk->outer = false;
    for (size_t p = 0; p < chunk->pair_count; p++) {
      size_t j = chunk->pair[p] & PAIR_MASK;
      if (j < g->begin || j >= g->end) g->wanted[j] = chunk->outer = true;
    }
  }
  TRY(ghosts_agree(g, s->count));
cleanup:
  memory_free(&g->wanted);
  return status;
}

void isph_send(struct isph *s, int count, const struct ghost_field *fields) {
  if (!isph_is_shared(s)) return;
  ghosts_post(&s->share, count, fields);
  ghosts_finish(&s->share);
}

void isph_gather_chunks(struct isph *s, void *data, size_t size) {
  if (isph_is_shared(s)) ranks_gather(data, s->chunk_cut, size);
}
