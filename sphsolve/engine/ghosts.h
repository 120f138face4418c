/* Clusters shared out among the ranks (common/ranks.h). Every rank numbers and orders all clusters
 * as one process would; it computes a run of them along the curve, its own, and of the others keeps
 * those fresh that its rows read: ghosts. So a row sums the same numbers in the same order on any
 * number of ranks, and gives the same bits. */
#ifndef TOSUI_ENGINE_GHOSTS_H
#define TOSUI_ENGINE_GHOSTS_H

#include "common/ranks.h"
#include "sphsolve/engine/neighbours.h"

/* Cuts lie at multiples of so many clusters: blocks of sums belong to one rank. */
#define GHOST_UNIT 256
#define GHOST_FIELDS 8

struct ghosts {
  int tag;
  size_t *cut;              /* [ranks + 1]: first cluster of each rank; NULL: there is one rank */
  size_t begin, end;        /* of this rank */
  double imbalance;         /* work of the busiest over the mean, when last cut */
  uint8_t *wanted;          /* [clusters] */
  uint32_t *send, *receive; /* clusters, rank by rank */
  size_t *send_start, *receive_start;
  float *out, *in; /* messages under way, and where they go: */
  int fields;
  void *array[GHOST_FIELDS];
  bool pending;
};

/* Cuts `clusters` clusters, evenly or by work: `work` [ranks] is that of the runs of the last cut.
 */
enum status ghosts_cut(struct ghosts *ghosts, size_t clusters, const double *work);
void ghosts_free(struct ghosts *ghosts);
/* Which clusters of others the rows [begin, end) of a list name: marked as wanted. Returns whether
 * there is any. */
bool ghosts_want(struct ghosts *ghosts, const struct neighbour_list *list, size_t begin,
                 size_t end);
/* Collective: tells the ranks what is wanted of them. */
enum status ghosts_agree(struct ghosts *ghosts, size_t clusters);
/* Collective: puts arrays of 4 bytes a slot under way; ghosts_finish waits, and fills the ghosts.
 */
void ghosts_post(struct ghosts *ghosts, int fields, void *const *arrays);
void ghosts_finish(struct ghosts *ghosts);
/* Collective: afterwards every rank has the whole array; `size` bytes a cluster. */
enum status ghosts_gather(const struct ghosts *ghosts, void *array, size_t size);

#endif
