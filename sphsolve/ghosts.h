/* Items, particles or clusters of them, shared out among the ranks (common/ranks.h). Every rank
 * numbers and orders all items as one process would; it computes a run of them in that order, its
 * own, and of the others keeps those fresh that its neighbour lists name: ghosts. So a row sums the
 * same numbers in the same order on any number of ranks, and gives the same bits. */
#ifndef TOSUI_SPHSOLVE_GHOSTS_H
#define TOSUI_SPHSOLVE_GHOSTS_H

#include "common/ranks.h"

#define GHOST_FIELDS 8

/* An array of all items, `size` bytes each. */
struct ghost_field {
  void *data;
  size_t size;
};

struct ghosts {
  int tag;
  size_t bytes_most;        /* of an item in one message */
  size_t *cut;              /* [ranks + 1]: first item of each rank; NULL: there is one rank */
  size_t begin, end;        /* of this rank */
  double imbalance;         /* work of the busiest over the mean, when last cut */
  uint8_t *wanted;          /* [items] */
  uint32_t *send, *receive; /* items, rank by rank */
  size_t *send_start, *receive_start;
  char *out, *in; /* messages under way, and where they go: */
  int fields;
  struct ghost_field field[GHOST_FIELDS];
  bool pending;
};

/* Collective: cuts `items` items at multiples of `unit`, evenly or, where the work of the last cut
 * is known (`own_work` of this rank, 0: not known) and uneven, by it. */
enum status ghosts_cut(struct ghosts *ghosts, size_t items, size_t unit, double own_work);
void ghosts_free(struct ghosts *ghosts);
/* Collective: tells the ranks which of their items are `wanted` here. */
enum status ghosts_agree(struct ghosts *ghosts, size_t items);
/* Collective: puts fields under way; ghosts_finish waits, and fills the ghosts. */
void ghosts_post(struct ghosts *ghosts, int count, const struct ghost_field *fields);
void ghosts_finish(struct ghosts *ghosts);
/* Collective: what this rank has summed for its ghosts, `count` numbers each, goes to their owners,
 * who add it to theirs. */
void ghosts_add(struct ghosts *ghosts, uint32_t *sums, size_t count);
/* Collective: afterwards every rank has the whole array; `size` bytes an item. */
void ghosts_gather(const struct ghosts *ghosts, void *array, size_t size);

#endif
