#include "sphsolve/isph/isph_ranks.h"

#include "common/memory.h"

#define TAG 5

enum status isph_share_out(struct isph *s) {
  enum status status = STATUS_OK;
  s->share.tag = TAG;
  s->share.bytes_most = sizeof(double[6]);
  if (s->block_cut == NULL)
    TRY(memory_allocate(&s->block_cut, (size_t)ranks_count() + 1, sizeof *s->block_cut, "shares"));
  TRY(ghosts_cut(&s->share, s->count, ISPH_BLOCK, s->pairs_now));
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

void isph_gather_blocks(struct isph *s, double *sums) {
  const size_t *cut = s->share.cut, ranks = (size_t)ranks_count();
  if (!isph_is_shared(s)) return;
  for (size_t r = 0; r <= ranks; r++) s->block_cut[r] = (cut[r] + ISPH_BLOCK - 1) / ISPH_BLOCK;
  ranks_gather(sums, s->block_cut, sizeof *sums);
}
