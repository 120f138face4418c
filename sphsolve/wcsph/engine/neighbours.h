/* Verlet lists from clusters to clusters.
 *
 * A list contains, for each row cluster, the column clusters whose box is within `range` of its
 * own, in ascending order (image by image). The boxes of fluid clusters leave room for future paths
 * (clusters.h): a list is valid until a particle leaves its box. Results do not depend on the
 * length of a list, since the pair loop drops every particle out of reach of the row cluster at its
 * present position. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_NEIGHBOURS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_NEIGHBOURS_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/ranks.h"
#include "sphsolve/wcsph/engine/clusters.h"

/* A row is a sequence of 16-bit words. A word is the difference from the last cluster (initially 0)
 * to the next, plus WORD_PAIR if the following cluster belongs to the list, too (a full vector of
 * 16). A difference of 0 is followed by 32 bits, low half first: the index of the cluster (the
 * highest bit marks a pair), or, with WORD_PAIR, the image of all that follow, as offsets of
 * IMAGE_BITS bits for x, y, z in units of one box; clusters then count from 0 again. Image 0 is the
 * default. */
#define WORD_PAIR 0x8000u
#define WORD_STEP 0x7fffu
#define IMAGE_BITS 8

#define LIST_CHUNKS 64
struct neighbour_list {
  size_t rows;
  /* Cluster of the first row; with several ranks, other ranks' clusters have no rows. */
  size_t first;
  uint32_t *start; /* [rows + 1]: first word of a row within its chunk */
  struct list_chunk {
    uint16_t *words;
    size_t used, capacity;
  } chunks[LIST_CHUNKS];
};

/* Rebuilds the list for rows->begin to rows->end. `widest`: largest common extent of rows that are
 * searched together, m; half of it, `range` and the half extents of two clusters must stay below
 * half of the box's images. */
enum status neighbours_build(const struct frame *frame, const struct cluster_set *rows,
                             const struct cluster_bins *columns, double range, double widest,
                             struct neighbour_list *list);
/* Renumbers the columns in the same order, by `number` of the old index, and the rows from `first`
 * on. */
enum status neighbours_renumber(struct neighbour_list *list, const uint32_t *number, size_t first);
void neighbours_free(struct neighbour_list *list);
size_t neighbours_bytes(const struct neighbour_list *list);

static inline size_t list_chunk_of(const struct neighbour_list *list, size_t row) {
  return row * LIST_CHUNKS / list->rows;
}
static inline size_t list_chunk_begin(const struct neighbour_list *list, size_t chunk) {
  return (chunk * list->rows + LIST_CHUNKS - 1) / LIST_CHUNKS;
}
/* First word of a row; *n: number of words. */
static inline const uint16_t *list_row(const struct neighbour_list *list, size_t row, size_t *n) {
  row -= list->first;
  const struct list_chunk *chunk = &list->chunks[list_chunk_of(list, row)];
  size_t last = list_chunk_begin(list, list_chunk_of(list, row) + 1) - 1;
  *n = (row == last ? chunk->used : list->start[row + 1]) - list->start[row];
  return chunk->words + list->start[row];
}

/* Reader of a row: clusters, single or in pairs, and their image. */
struct list_reader {
  const uint16_t *word, *end;
  uint32_t cluster, image;
  bool pair, turned; /* `turned`: the image has changed */
};
static inline bool list_next(struct list_reader *reader) {
  reader->turned = false;
  while (reader->word < reader->end) {
    uint32_t word = *reader->word++, step = word & WORD_STEP;
    reader->pair = (word & WORD_PAIR) != 0;
    if (__builtin_expect(step != 0, 1)) {
      reader->cluster += step;
      return true;
    }
    uint32_t whole = reader->word[0] | (uint32_t)reader->word[1] << 16;
    reader->word += 2;
    if (!reader->pair) {
      reader->cluster = whole & ~0x80000000u;
      reader->pair = (whole & 0x80000000u) != 0;
      return true;
    }
    reader->image = whole;
    reader->cluster = 0;
    reader->turned = true;
  }
  return false;
}

#endif
