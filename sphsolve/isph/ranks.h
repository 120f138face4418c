/* Particles of method isph shared out among the ranks. In the order of their cells each rank
 * computes a run of them, and holds besides, as its ghosts, those of the layers of cells (across
 * the longest axis) that its kernels reach: always in that order, [local.begin, local.end) its own.
 * It exchanges what its neighbours' sums read. On one rank the run is all of them, and nothing here
 * does anything. */
#ifndef TOSUI_SPHSOLVE_ISPH_RANKS_H
#define TOSUI_SPHSOLVE_ISPH_RANKS_H

#include "sphsolve/isph/state.h"

static inline bool isph_is_distributed(const struct isph *s) {
  return RANKS && s->local.partition != NULL;
}
/* Collective, before a sort: who computes what, by the pairs of the last step. Takes all particles
 * here as its own, and leaves its own and ghosts, unsorted. */
enum status isph_distribute(struct isph *s);
/* After it: which of those here are its own. */
void isph_find_own(struct isph *s);
/* Whether this rank answers for a place: it holds all particles within the kernel's reach, and no
 * rank before it does. */
bool isph_answers_for(const struct isph *s, const double x[3]);
/* Collective, after the search: the ghosts to keep fresh are what the pairs name. */
enum status isph_find_ghosts(struct isph *s);
/* Collective: sends fields of the own particles to the ranks that read them. */
void isph_send(struct isph *s, int count, const struct ghost_field *fields);
#define ISPH_FIELD(array) ((struct ghost_field){(array), sizeof *(array)})

/* Collective: adds up s->sums, of which each chunk has `width`, of all chunks in their order: the
 * same bits on any number of ranks and threads. */
void isph_sum_chunks(const struct isph *s, int width, double *total);
/* Collective: the same of the chunks' budgets, to that of the run. */
void isph_sum_budgets(struct isph *s);
/* Place of the first own chunk among those of all. */
static inline size_t isph_first_chunk(const struct isph *s) {
  return isph_is_distributed(s) ? s->chunk_partition[ranks_own()] : 0;
}
/* Collective: of a number for each chunk of all particles, each rank has those of its own; then all
 * have all. */
void isph_gather_chunks(struct isph *s, double *numbers);

/* Collective: the lists of all ranks, `count` items of `size` bytes here, one after another;
 * *gathered, NULL before, is to be freed. */
enum status isph_gather(const void *list, size_t count, size_t size, void *gathered, size_t *total);

#endif
