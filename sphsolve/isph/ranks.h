/* What the ranks of method isph exchange. In the order of their cells (sort.h) each rank computes a
 * contiguous range of particles. It holds besides, as ghosts, those of the layers of cells (across
 * the longest axis) that its kernels reach. All are stored in that order, with [local.begin,
 * local.end) its own. Ranks exchange what their neighbours' sums read. On one rank the range is all
 * particles, and nothing here has any effect. */
#ifndef TOSUI_SPHSOLVE_ISPH_RANKS_H
#define TOSUI_SPHSOLVE_ISPH_RANKS_H

#include "sphsolve/isph/state.h"

static inline bool isph_is_distributed(const struct isph *s) {
  return RANKS && s->local.partition != NULL;
}
/* Collective: sends fields of the own particles to the ranks that read them. */
void isph_send(struct isph *s, int count, const struct ghost_field *fields);
#define ISPH_FIELD(array) ((struct ghost_field){(array), sizeof *(array)})

/* Collective: adds up s->sums, `width` numbers per chunk, over all chunks in their order: the same
 * to the bit on any number of ranks and threads. */
void isph_sum_chunks(const struct isph *s, int width, double *total);
/* Collective: adds up the chunks' budgets into that of the run, in the same way. */
void isph_sum_budgets(struct isph *s);
/* Index of the first own chunk among those of all ranks. */
static inline size_t isph_first_chunk(const struct isph *s) {
  return isph_is_distributed(s) ? s->chunk_partition[ranks_own()] : 0;
}
/* Collective: `numbers` has one number for each chunk of all particles. Each rank provides those of
 * its own chunks; afterwards all ranks have all. */
void isph_gather_chunks(struct isph *s, double *numbers);

/* Collective: concatenates the lists of all ranks, here `count` items of `size` bytes. *gathered
 * has to be NULL before and is to be freed by the caller. */
enum status isph_gather(const void *list, size_t count, size_t size, void *gathered, size_t *total);

#endif
