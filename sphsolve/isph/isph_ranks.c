#include "sphsolve/isph/isph_ranks.h"

#include "common/memory.h"

/* Cuts lie at multiples of so many particles. */
#define UNIT 16
#define TAG 5

enum status isph_share_out(struct isph *s) {
  s->share.tag = TAG;
  s->share.bytes_most = sizeof(double[6]);
  return ghosts_cut(&s->share, s->count, UNIT, s->pairs_now);
}

enum status isph_find_ghosts(struct isph *s) {
  enum status status = STATUS_OK;
  struct ghosts *g = &s->share;
  if (!isph_is_shared(s)) return STATUS_OK;
  TRY(memory_allocate(&g->wanted, s->count + 1, 1, "ghosts"));
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t p = 0; p < s->chunks[c].pair_count; p++) {
      size_t j = s->chunks[c].pair[p] & PAIR_MASK;
      if (j < g->begin || j >= g->end) g->wanted[j] = 1;
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
