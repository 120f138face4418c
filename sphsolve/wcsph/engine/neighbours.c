#include "sphsolve/wcsph/engine/neighbours.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"

/* Only integers and comparisons of unfused floats are used, so that every variant gives the same
 * lists. */

struct found {
  uint64_t *key, *sorted;           /* image << 32 | cluster */
  uint32_t *member, *sorted_member; /* its index in the bins */
  float *square, *at[3], *half[3];
  size_t n, picked, capacity;
};

/* Reserves room for `more` further clusters and their squared gaps. */
static enum status found_reserve(struct found *found, size_t more) {
  enum status status = STATUS_OK;
  if (found->n + more + 1 <= found->capacity) return STATUS_OK;
  size_t capacity = 2 * (found->n + more) + 256;
  TRY(memory_resize(&found->key, capacity, sizeof *found->key, "neighbour clusters"));
  TRY(memory_resize(&found->sorted, capacity, sizeof *found->sorted, "neighbour clusters"));
  TRY(memory_resize(&found->member, capacity, sizeof *found->member, "neighbour clusters"));
  TRY(memory_resize(&found->sorted_member, capacity, sizeof(uint32_t), "neighbour clusters"));
  TRY(memory_resize(&found->square, capacity, sizeof *found->square, "neighbour clusters"));
  for (int a = 0; a < 3; a++) {
    TRY(memory_resize(&found->at[a], capacity, sizeof(float), "neighbour clusters"));
    TRY(memory_resize(&found->half[a], capacity, sizeof(float), "neighbour clusters"));
  }
  found->capacity = capacity;
cleanup:
  return status;
}

static void found_free(struct found *found) {
  MEMORY_FREE(&found->key, &found->sorted, &found->member, &found->sorted_member, &found->square);
  for (int a = 0; a < 3; a++) {
    MEMORY_FREE(&found->at[a], &found->half[a]);
  }
}

/* Sorts in ascending order by counting the smaller keys: n is at most a few hundred, and this
 * vectorises well. */
TARGETS static void found_sort(struct found *found) {
  size_t n = found->n;
  const uint64_t *key = found->key;
  for (size_t i = 0; i < n; i++) {
    uint64_t own = key[i], rank = 0;
    for (size_t j = 0; j < n; j++) rank += key[j] < own;
    found->sorted[rank] = own;
    found->sorted_member[rank] = found->member[i];
  }
  uint64_t *key_swap = found->key;
  found->key = found->sorted;
  found->sorted = key_swap;
  uint32_t *member_swap = found->member;
  found->member = found->sorted_member;
  found->sorted_member = member_swap;
}

/* Positions of the cells [low, high] of an axis: in the box, and in which of its images. Cells are
 * at least as wide as the range of the lists, and boxes not many times wider, so that this number
 * is never exceeded. */
#define AXIS_CELLS 512
struct axis_cells {
  int count;
  uint16_t cell[AXIS_CELLS];
  uint32_t image[AXIS_CELLS];
};

static void axis_find(const struct frame *frame, const struct cluster_bins *bins,
                      const struct cluster_box *row, double range, int a, struct axis_cells *axis) {
  int n = bins->cells[a];
  axis->count = 1;
  axis->cell[0] = 0;
  axis->image[0] = 0;
  if (frame->step[a] == 0) return;
  double cell = frame->length[a] / n, at = frame->unit[a] * (double)row->centre[a];
  double around = range + frame->unit[a] * ((double)row->half[a] + (double)bins->half_max[a]);
  long low = (long)floor((at - around) / cell), high = (long)floor((at + around) / cell);
  long all = (long)n << frame->image_bits[a];
  if (high - low + 1 > all) high = low + all - 1;
  if (high - low + 1 > AXIS_CELLS) high = low + AXIS_CELLS - 1;
  long box = low >= 0 ? low / n : -((n - 1 - low) / n), in = low - box * n;
  for (axis->count = 0; low <= high; low++) {
    axis->cell[axis->count] = (uint16_t)in;
    axis->image[axis->count++] = (uint32_t)box & ((1u << frame->image_bits[a]) - 1);
    if (++in == n) in = 0, box++;
  }
}

/* Squared gaps between the box of the row and those of columns [begin, end) of the bins. */
TARGETS static void find_gaps(const struct cluster_bins *bins, size_t begin, size_t end,
                              const uint32_t from[3], const uint32_t half[3], const float unit[3],
                              float *restrict square) {
  for (size_t m = begin; m < end; m++) {
    float sum = 0;
    for (int a = 0; a < 3; a++) {
      float d = fabsf((float)(int32_t)(cluster_bins_centre(bins, a, m) - from[a]));
      float gap = (d - (float)(int32_t)(cluster_bins_half(bins, a, m) + half[a])) * unit[a];
      gap = gap > 0 ? gap : 0;
      sum += gap * gap;
    }
    square[m - begin] = sum; // NOLINT: no room is asked for only where begin == end
  }
}

/* Finds all column clusters and images within range of a box, unordered. */
static enum status search_box(const struct frame *frame, const struct cluster_bins *bins,
                              const struct cluster_box *row, double range, struct found *found) {
  enum status status = STATUS_OK;
  struct axis_cells axis[3];
  for (int a = 0; a < 3; a++) axis_find(frame, bins, row, range, a, &axis[a]);
  float limit = (float)(range * range), unit[3];
  bool images = false;
  for (int a = 0; a < 3; a++) {
    unit[a] = (float)frame->unit[a];
    images = images || frame->image_bits[a] > 0;
  }
  found->n = 0;
  for (int k = 0; k < axis[2].count; k++)
    for (int j = 0; j < axis[1].count; j++)
      for (int i = 0; i < axis[0].count;) {
        /* Members of consecutive cells along x are contiguous. */
        int run = 1;
        while (i + run < axis[0].count && axis[0].cell[i + run] == axis[0].cell[i] + run &&
               axis[0].image[i + run] == axis[0].image[i])
          run++;
        size_t cell = ((size_t)axis[2].cell[k] * (size_t)bins->cells[1] + axis[1].cell[j]) *
                          (size_t)bins->cells[0] +
                      axis[0].cell[i];
        size_t begin = bins->start[cell], end = bins->start[cell + (size_t)run];
        TRY(found_reserve(found, end - begin));
        if (!images) {
          find_gaps(bins, begin, end, row->centre, row->half, unit, found->square);
          for (size_t m = begin; m < end; m++) {
            found->key[found->n] = bins->member[m]; // NOLINT: reserved above
            found->member[found->n] = (uint32_t)m;
            found->n += found->square[m - begin] < limit;
          }
        } else {
          uint32_t at[3] = {axis[0].image[i], axis[1].image[j], axis[2].image[k]};
          for (size_t m = begin; m < end; m++) {
            uint32_t from[3], image = 0;
            for (int a = 0; a < 3; a++) {
              /* The centre of the column may lie in an image of the cell. */
              int bits = frame->image_bits[a];
              from[a] = row->centre[a];
              if (bits == 0) continue;
              uint32_t own =
                  (at[a] - (cluster_bins_centre(bins, a, m) >> (32 - bits))) & ((1u << bits) - 1);
              from[a] -= own << (32 - bits);
              image |= own << (IMAGE_BITS * a);
            }
            find_gaps(bins, m, m + 1, from, row->half, unit, found->square);
            // NOLINTNEXTLINE: reserved above
            found->key[found->n] = (uint64_t)image << 32 | bins->member[m];
            found->member[found->n] = (uint32_t)m;
            found->n += found->square[0] < limit;
          }
        }
        i += run;
      }
cleanup:
  return status;
}

static enum status chunk_reserve(struct list_chunk *chunk, size_t more) {
  enum status status = STATUS_OK;
  if (chunk->used + more <= chunk->capacity) return STATUS_OK;
  size_t capacity = chunk->used + more + chunk->capacity / 4 + 256;
  TRY(memory_resize(&chunk->words, capacity, sizeof *chunk->words, "neighbour lists"));
  chunk->capacity = capacity;
cleanup:
  return status;
}

/* Rows are searched in groups of up to GROUP consecutive ones on the curve: the neighbourhood of
 * the group is found and sorted once, then each row selects its own columns. */
#define GROUP 6
struct group {
  struct cluster_box box;
  size_t rows;
};

/* Groups the rows from `first` on while their common box is narrower than `widest` (m). */
static struct group group_make(const struct frame *frame, const struct cluster_set *rows,
                               size_t first, size_t end, double widest) {
  struct group group = {.rows = 0};
  const struct cluster_box *boxes = rows->boxes;
  double low[3] = {0}, high[3] = {0};
  for (size_t r = first; r < end && group.rows < GROUP; r++, group.rows++) {
    double next_low[3], next_high[3];
    bool fits = true;
    for (int a = 0; a < 3; a++) {
      double d = frame->unit[a] * (int32_t)(boxes[r].centre[a] - boxes[first].centre[a]);
      double half = frame->unit[a] * (double)boxes[r].half[a];
      next_low[a] = fmin(low[a], d - half);
      next_high[a] = fmax(high[a], d + half);
      fits = fits && next_high[a] - next_low[a] <= widest;
    }
    if (!fits && r > first) break;
    memcpy(low, next_low, sizeof low);
    memcpy(high, next_high, sizeof high);
  }
  for (int a = 0; a < 3; a++) {
    double middle = 0.5 * (low[a] + high[a]);
    group.box.centre[a] =
        boxes[first].centre[a] + (uint32_t)(int32_t)lrint(middle / frame->unit[a]);
    /* Margin for the rounding of the centre to a unit. */
    group.box.half[a] = (uint32_t)(0.5 * (high[a] - low[a]) / frame->unit[a]) + 2;
  }
  return group;
}

/* Boxes of the columns found, relative to the centre of a group. */
static void place_found(const struct frame *frame, const struct cluster_bins *bins,
                        const struct cluster_box *group, struct found *found) {
  for (size_t i = 0; i < found->n; i++) {
    uint32_t image = (uint32_t)(found->key[i] >> 32), m = found->member[i];
    for (int a = 0; a < 3; a++) {
      int bits = frame->image_bits[a];
      uint32_t own = image >> (IMAGE_BITS * a) & ((1u << IMAGE_BITS) - 1);
      uint32_t offset = bits == 0 ? 0 : own << (32 - bits);
      found->at[a][i] =
          (float)(int32_t)(cluster_bins_centre(bins, a, m) + offset - group->centre[a]) *
          (float)frame->unit[a];
      found->half[a][i] = (float)cluster_bins_half(bins, a, m) * (float)frame->unit[a];
    }
  }
}

/* Squared gaps between the box of a row and those found. */
TARGETS static void row_gaps(const struct found *found, const float at[3], const float half[3],
                             float *restrict square) {
  for (size_t m = 0; m < found->n; m++) {
    float sum = 0;
    for (int a = 0; a < 3; a++) {
      float gap = fabsf(found->at[a][m] - at[a]) - found->half[a][m] - half[a];
      gap = gap > 0 ? gap : 0;
      sum += gap * gap;
    }
    square[m] = sum;
  }
}

/* Selects the columns of one row from those of its group, in order. */
static void pick_row(const struct frame *frame, const struct cluster_box *row,
                     const struct cluster_box *group, double range, struct found *found) {
  float at[3], half[3], limit = (float)(range * range);
  size_t n = 0;
  for (int a = 0; a < 3; a++) {
    at[a] = (float)(int32_t)(row->centre[a] - group->centre[a]) * (float)frame->unit[a];
    half[a] = (float)row->half[a] * (float)frame->unit[a];
  }
  row_gaps(found, at, half, found->square);
  for (size_t m = 0; m < found->n; m++) {
    found->sorted[n] = found->key[m];
    n += found->square[m] < limit;
  }
  found->picked = n;
}

static uint16_t *put_long(uint16_t *word, uint16_t mark, uint32_t whole) {
  *word++ = mark;
  *word++ = (uint16_t)whole;
  *word++ = (uint16_t)(whole >> 16);
  return word;
}

static enum status encode_row(const struct found *found, struct list_chunk *chunk) {
  enum status status = STATUS_OK;
  uint32_t image = 0, last = 0;
  const uint64_t *key = found->sorted;
  TRY(chunk_reserve(chunk, 6 * found->picked));
  uint16_t *word = chunk->words + chunk->used;
  for (size_t i = 0; i < found->picked;) {
    uint32_t own = (uint32_t)(key[i] >> 32), cluster = (uint32_t)key[i];
    bool pair = i + 1 < found->picked && key[i + 1] == key[i] + 1;
    if (own != image) {
      word = put_long(word, WORD_PAIR, own);
      last = 0;
    }
    uint32_t step = cluster - last;
    if (step != 0 && step <= WORD_STEP)
      *word++ = (uint16_t)((pair ? WORD_PAIR : 0) | step);
    else
      word = put_long(word, 0, cluster | (pair ? 0x80000000u : 0));
    image = own;
    last = cluster;
    i += pair ? 2 : 1;
  }
  chunk->used = (size_t)(word - chunk->words);
cleanup:
  return status;
}

enum status neighbours_build(const struct frame *frame, const struct cluster_set *rows,
                             const struct cluster_bins *columns, double range, double widest,
                             struct neighbour_list *list) {
  enum status status = STATUS_OK;
  if (columns->clusters >= 0x80000000u)
    TRY_FAIL(STATUS_RUN, "%zu clusters are more than a neighbour list can name", columns->clusters);
  const size_t first = rows->begin, count = rows->end - first;
  if (list->rows != count) {
    memory_free(&list->start);
    TRY(memory_allocate(&list->start, count + 1, sizeof *list->start, "neighbour lists"));
    list->rows = count;
  }
  list->first = first;
  if (count == 0) goto cleanup;
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t chunk = 0; chunk < LIST_CHUNKS; chunk++) {
    struct found found = {0};
    struct list_chunk *to = &list->chunks[chunk];
    enum status failed = STATUS_OK;
    to->used = 0;
    size_t r = list_chunk_begin(list, chunk), end = list_chunk_begin(list, chunk + 1);
    while (r < end && failed == STATUS_OK) {
      struct group group = group_make(frame, rows, first + r, first + end, widest);
      failed = search_box(frame, columns, &group.box, range, &found);
      found_sort(&found);
      place_found(frame, columns, &group.box, &found);
      for (size_t last = r + group.rows; r < last && failed == STATUS_OK; r++) {
        list->start[r] = (uint32_t)to->used;
        pick_row(frame, &rows->boxes[first + r], &group.box, range, &found);
        failed = encode_row(&found, to);
      }
    }
    if (failed == STATUS_OK && to->capacity > to->used + to->used / 8 + 64) {
      failed = memory_resize(&to->words, to->used, sizeof *to->words, "neighbour lists");
      to->capacity = to->used;
    }
    found_free(&found);
    if (failed != STATUS_OK) {
#pragma omp atomic write
      status = failed;
    }
  }
cleanup:
  return status;
}

static enum status renumber_chunk(const struct neighbour_list *list, size_t chunk,
                                  const uint32_t *number, struct found *found,
                                  struct list_chunk *to, uint32_t *start) {
  enum status status = STATUS_OK;
  const size_t first = list_chunk_begin(list, chunk), end = list_chunk_begin(list, chunk + 1);
  for (size_t r = first; r < end; r++) {
    size_t words;
    struct list_reader reader = {.word = list_row(list, list->first + r, &words)};
    reader.end = reader.word + words;
    found->picked = found->n = 0;
    TRY(found_reserve(found, 2 * words));
    while (list_next(&reader))
      for (uint32_t c = reader.cluster; c <= reader.cluster + (reader.pair ? 1 : 0); c++)
        // NOLINTNEXTLINE: reserved above, one at least
        found->sorted[found->picked++] = (uint64_t)reader.image << 32 | number[c];
    start[r - first] = (uint32_t)to->used;
    TRY(encode_row(found, to));
  }
cleanup:
  return status;
}

enum status neighbours_renumber(struct neighbour_list *list, const uint32_t *number, size_t first) {
  enum status status = STATUS_OK;
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t chunk = 0; chunk < LIST_CHUNKS; chunk++) {
    struct found found = {0};
    struct list_chunk to = {0};
    uint32_t *start = NULL;
    if (list->rows == 0) continue;
    const size_t begin = list_chunk_begin(list, chunk),
                 rows = list_chunk_begin(list, chunk + 1) - begin;
    enum status failed = memory_allocate(&start, rows + 1, sizeof *start, "neighbour lists");
    if (failed == STATUS_OK) failed = renumber_chunk(list, chunk, number, &found, &to, start);
    if (failed == STATUS_OK && to.used < to.capacity)
      failed = memory_resize(&to.words, to.used, sizeof *to.words, "neighbour lists");
    if (failed == STATUS_OK) {
      to.capacity = to.used;
      memory_free(&list->chunks[chunk].words);
      list->chunks[chunk] = to;
      memcpy(list->start + begin, start, rows * sizeof *start);
    } else {
      memory_free(&to.words);
#pragma omp atomic write
      status = failed;
    }
    memory_free(&start);
    found_free(&found);
  }
  list->first = first;
  return status;
}

void neighbours_free(struct neighbour_list *list) {
  memory_free(&list->start);
  for (size_t c = 0; c < LIST_CHUNKS; c++) memory_free(&list->chunks[c].words);
  memset(list, 0, sizeof *list);
}

size_t neighbours_bytes(const struct neighbour_list *list) {
  size_t bytes = list->rows * sizeof *list->start;
  for (size_t c = 0; c < LIST_CHUNKS; c++)
    bytes += list->chunks[c].capacity * sizeof *list->chunks[c].words;
  return bytes;
}
