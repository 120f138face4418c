/* Verlet lists from clusters to clusters.
 *
 * A list holds, for each row cluster, the column clusters whose bounding box comes within `range`
 * of its own, in ascending order (image by image). Exactness is
 * left to the pair loop, which drops every particle out of reach of the row cluster as it now
 * stands: a longer list changes no bit of a result. */
#ifndef TOSUI_ENGINE_NEIGHBOURS_H
#define TOSUI_ENGINE_NEIGHBOURS_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/engine/particles.h"

/* An entry is a cluster, with RUN_PAIR two consecutive ones (a full vector of 16), or, with
 * RUN_IMAGE set, names the image of those after it: offsets of RUN_IMAGE_BITS bits for x, y, z in
 * units of one box. Image 0 need not be named. */
#define RUN_START_BITS 26
#define RUN_START ((1u << RUN_START_BITS) - 1)
#define RUN_PAIR (1u << RUN_START_BITS)
#define RUN_IMAGE 0x80000000u
#define RUN_IMAGE_BITS 8

struct cluster_box {
  uint32_t centre[3];
  float half[3]; /* m */
};

#define LIST_CHUNKS 64
struct neighbour_list {
  size_t rows;
  uint32_t *start; /* [rows + 1]: first entry of a row within its chunk */
  struct list_chunk {
    uint32_t *entries;
    size_t used, capacity;
  } chunks[LIST_CHUNKS];
};

struct cluster_set {
  size_t clusters;
  struct cluster_box *boxes;
};

enum status cluster_boxes_fluid(const struct particles *particles, struct cluster_set *set);
enum status cluster_boxes_wall(const struct particles *particles, struct cluster_set *set);
void cluster_set_free(struct cluster_set *set);

/* Replaces the list. `widest`: extent that rows may have when they are searched together, m; half
 * of it, `range` and the half extents of two clusters stay below half of the box's images. */
enum status neighbours_build(const struct frame *frame, const struct cluster_set *rows,
                             const struct cluster_set *columns, double range, double widest,
                             struct neighbour_list *list);
void neighbours_free(struct neighbour_list *list);
size_t neighbours_bytes(const struct neighbour_list *list);

static inline size_t list_chunk_of(const struct neighbour_list *list, size_t row) {
  return row * LIST_CHUNKS / list->rows;
}
static inline size_t list_chunk_begin(const struct neighbour_list *list, size_t chunk) {
  return (chunk * list->rows + LIST_CHUNKS - 1) / LIST_CHUNKS;
}
/* Entries of a row. */
static inline const uint32_t *list_row(const struct neighbour_list *list, size_t row, size_t *n) {
  const struct list_chunk *chunk = &list->chunks[list_chunk_of(list, row)];
  size_t last = list_chunk_begin(list, list_chunk_of(list, row) + 1) - 1;
  *n = (row == last ? chunk->used : list->start[row + 1]) - list->start[row];
  return chunk->entries + list->start[row];
}

#endif
