/* Items (particles, or clusters of them) distributed over the ranks (common/ranks.h), and the
 * exchange of their ghosts. Items have one global order, that of a single process. A rank computes
 * a contiguous range of them, and holds copies (ghosts) of those items of other ranks that are in
 * its neighbour lists, in the same order. A row thus sums the same numbers in the same order on any
 * number of ranks, and the result is bitwise identical. */
#ifndef TOSUI_SPHSOLVE_PARALLEL_GHOSTS_H
#define TOSUI_SPHSOLVE_PARALLEL_GHOSTS_H

#include "common/error.h"
#include "common/ranks.h"

#define GHOST_FIELDS 8

/* An array over the items of this rank, `size` bytes each. */
struct ghost_field {
  void *data;
  size_t size;
};

struct ghosts {
  int tag;
  size_t bytes_most; /* largest size of an item in one message */
  size_t *partition; /* [ranks + 1]: first item of each rank; NULL with one rank */
  size_t begin, end; /* own items of this rank, in its arrays */
  uint32_t *number;  /* [items held]: global index; NULL: the items are held in `runs` */
  int runs;          /* number of contiguous ranges; 0: all items are held */
  struct {
    size_t here, number; /* first item: index in the arrays, and global index */
  } run[3];
  double imbalance;         /* maximum work / mean work of the ranks at the last partition */
  uint8_t *wanted;          /* [items held]: whether it is needed as a ghost */
  uint32_t *send, *receive; /* items, rank by rank */
  size_t *send_start, *receive_start;
  char *out, *in; /* buffers of the messages, and the fields that they carry: */
  int fields;
  struct ghost_field field[GHOST_FIELDS];
  bool pending;
};

/* Collective: partitions `items` items at multiples of `unit`: evenly the first time; later as
 * before, or by Zoltan if the load of the busiest rank is too far above the mean. `work`: of each
 * unit of this rank in the last partition; NULL on all ranks if it is unknown. */
enum status ghosts_partition(struct ghosts *ghosts, size_t items, size_t unit, const double *work);
void ghosts_free(struct ghosts *ghosts);
/* Global index of item `here`. */
static inline size_t ghosts_number(const struct ghosts *g, size_t here) {
  size_t number = here;
  if (g->number != NULL) return g->number[here];
  for (int k = 0; k < g->runs && here >= g->run[k].here; k++)
    number = g->run[k].number + (here - g->run[k].here);
  return number;
}
/* Collective: sets up the messages; each rank learns which of its items are `wanted` by others.
 * `items`: number of items held. */
enum status ghosts_plan_exchange(struct ghosts *ghosts, size_t items);
/* Frees the message buffers until the next ghosts_plan_exchange. */
void ghosts_free_buffers(struct ghosts *ghosts);
/* Collective: starts to send fields of the own items to the ranks where they are ghosts.
 * ghosts_finish waits for the messages and stores them in the ghosts of this rank. */
void ghosts_post(struct ghosts *ghosts, int count, const struct ghost_field *fields);
void ghosts_finish(struct ghosts *ghosts);
/* Collective: sends the sums of this rank's ghosts, `count` numbers each, to their owners, which
 * add them to their own. */
void ghosts_add(struct ghosts *ghosts, uint32_t *sums, size_t count);
/* Collective: sends send[r] items of `size` bytes, contiguous in `out`, to rank r. *in (to be
 * freed) receives the items in the order of the ranks, those of rank r from start[r] on; start is
 * [ranks + 1]. Nothing is sent to the own rank: its place in *in, of send[own] items, is left to be
 * filled. */
enum status ghosts_exchange(size_t size, const size_t *send, const void *out, size_t *start,
                            void *in);

#endif
