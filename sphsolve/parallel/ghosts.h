/* Items (particles, or clusters of them) divided among the ranks (common/ranks.h), and the exchange
 * of their ghosts. Items have one order, that of a single process. A rank computes a run of them,
 * its own, and holds copies, ghosts, of those of other ranks that its neighbour lists name, in that
 * order too. So a row sums the same numbers in the same order on any number of ranks, and gives the
 * same bits. */
#ifndef TOSUI_SPHSOLVE_PARALLEL_GHOSTS_H
#define TOSUI_SPHSOLVE_PARALLEL_GHOSTS_H

#include "common/error.h"
#include "common/ranks.h"

#define GHOST_FIELDS 8

/* An array of the items here, `size` bytes each. */
struct ghost_field {
  void *data;
  size_t size;
};

struct ghosts {
  int tag;
  size_t bytes_most; /* of an item in one message */
  size_t *partition; /* [ranks + 1]: first item of each rank; NULL: there is one rank */
  size_t begin, end; /* of this rank, in its arrays */
  uint32_t *number;  /* [items here]: place in the order of all; NULL: they are here in runs */
  int runs;          /* held; 0: all items are */
  struct {
    size_t here, number; /* of the first: in the arrays, and in the order of all */
  } run[3];
  double imbalance;         /* work of the busiest over the mean, when last partitioned */
  uint8_t *wanted;          /* [items here] */
  uint32_t *send, *receive; /* items, rank by rank */
  size_t *send_start, *receive_start;
  char *out, *in; /* messages under way, and where they go: */
  int fields;
  struct ghost_field field[GHOST_FIELDS];
  bool pending;
};

/* Collective: partitions `items` items at multiples of `unit`: evenly at first; then as the last
 * time, or by Zoltan where the busiest rank had too much more than the mean. `work`: of this rank's
 * units of the last partition, counted; NULL on all ranks where it is not known. */
enum status ghosts_partition(struct ghosts *ghosts, size_t items, size_t unit, const double *work);
void ghosts_free(struct ghosts *ghosts);
/* The place of item `here` in the order of all. */
static inline size_t ghosts_number(const struct ghosts *g, size_t here) {
  size_t number = here;
  if (g->number != NULL) return g->number[here];
  for (int k = 0; k < g->runs && here >= g->run[k].here; k++)
    number = g->run[k].number + (here - g->run[k].here);
  return number;
}
/* Collective: sets up the messages, as each rank learns which of its items are `wanted` on others;
 * `items`: how many are held here. */
enum status ghosts_plan_exchange(struct ghosts *ghosts, size_t items);
/* Frees the buffers of the messages until they are set up again. */
void ghosts_free_buffers(struct ghosts *ghosts);
/* Collective: starts to send fields of the own items to where they are ghosts; ghosts_finish waits
 * for what comes, and puts it into the ghosts here. */
void ghosts_post(struct ghosts *ghosts, int count, const struct ghost_field *fields);
void ghosts_finish(struct ghosts *ghosts);
/* Collective: what this rank has summed for its ghosts, `count` numbers each, goes to their owners,
 * who add it to theirs. */
void ghosts_add(struct ghosts *ghosts, uint32_t *sums, size_t count);
/* Collective: send[r] items of `size` bytes, after each other in `out`, go to rank r; what comes,
 * in the order of the ranks, is *in (to be freed), from start[r] on [ranks + 1]. Nothing goes to
 * oneself: of *in the place of the own send[own] is left to be filled. */
enum status ghosts_exchange(size_t size, const size_t *send, const void *out, size_t *start,
                            void *in);

#endif
