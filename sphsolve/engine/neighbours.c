#include "sphsolve/engine/neighbours.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"

static void box_of(const struct frame *frame, uint32_t (*x)[3], int members,
                   struct cluster_box *box) {
  for (int a = 0; a < 3; a++) {
    int32_t low = 0, high = 0;
    for (int m = 1; m < members; m++) {
      int32_t d = (int32_t)(x[m][a] - x[0][a]);
      if (d < low) low = d;
      if (d > high) high = d;
    }
    int64_t span = (int64_t)high - low;
    box->centre[a] = x[0][a] + (uint32_t)low + (uint32_t)(span / 2);
    box->half[a] = (float)(frame->unit[a] * (double)(span - span / 2));
  }
}

enum status cluster_boxes_fluid(const struct particles *p, struct cluster_set *set) {
  enum status status = STATUS_OK;
  set->clusters = p->clusters;
  TRY(memory_allocate(&set->boxes, p->clusters, sizeof *set->boxes, "cluster boxes"));
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < p->clusters; c++) {
    uint32_t x[CLUSTER][3];
    int members = 0;
    for (size_t i = c * CLUSTER; i < (c + 1) * CLUSTER; i++) {
      if (p->id[i] == NO_PARTICLE) continue;
      for (int a = 0; a < 3; a++) x[members][a] = p->x[a][i];
      members++;
    }
    box_of(&p->frame, x, members, &set->boxes[c]);
  }
cleanup:
  return status;
}

enum status cluster_boxes_wall(const struct particles *p, struct cluster_set *set) {
  enum status status = STATUS_OK;
  set->clusters = p->wall_clusters;
  TRY(memory_allocate(&set->boxes, p->wall_clusters, sizeof *set->boxes, "cluster boxes"));
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < p->wall_clusters; c++) {
    uint32_t x[CLUSTER][3];
    int members = 0;
    for (size_t i = c * CLUSTER; i < (c + 1) * CLUSTER; i++) {
      if (p->site[0][i] == NO_SITE) continue;
      for (int a = 0; a < 3; a++) x[members][a] = frame_site_position(&p->frame, a, p->site[a][i]);
      members++;
    }
    box_of(&p->frame, x, members, &set->boxes[c]);
  }
cleanup:
  return status;
}

void cluster_set_free(struct cluster_set *set) {
  memory_free(&set->boxes);
  set->clusters = 0;
}

/* Column clusters binned by the cell of their centre. */
struct bins {
  int cells[3];
  uint32_t *start, *member;
  float half_max[3];
};

static void bin_cell(const struct frame *frame, const struct bins *bins, const uint32_t at[3],
                     int cell[3]) {
  for (int a = 0; a < 3; a++) {
    /* A centre may lie beyond the box by its own image: fold it back. */
    uint64_t folded = (uint64_t)(at[a] << frame->image_bits[a]);
    cell[a] = (int)((folded * (uint64_t)bins->cells[a]) >> 32);
  }
}

static enum status bins_make(const struct frame *frame, const struct cluster_set *columns,
                             double size, struct bins *bins) {
  enum status status = STATUS_OK;
  size_t cells = 1;
  memset(bins, 0, sizeof *bins);
  for (int a = 0; a < 3; a++) {
    bins->cells[a] = frame->step[a] == 0 ? 1 : (int)fmin(1024, fmax(1, frame->length[a] / size));
    cells *= (size_t)bins->cells[a];
  }
  TRY(memory_allocate(&bins->start, cells + 2, sizeof *bins->start, "cluster cells"));
  TRY(memory_allocate(&bins->member, columns->clusters, sizeof *bins->member, "cluster cells"));
  for (int pass = 0; pass < 2; pass++) {
    for (size_t c = 0; c < columns->clusters; c++) {
      int cell[3];
      bin_cell(frame, bins, columns->boxes[c].centre, cell);
      size_t i =
          ((size_t)cell[2] * (size_t)bins->cells[1] + (size_t)cell[1]) * (size_t)bins->cells[0] +
          (size_t)cell[0];
      if (pass == 0)
        bins->start[i + 2]++;
      else
        bins->member[bins->start[i + 1]++] = (uint32_t)c;
    }
    if (pass == 0)
      for (size_t i = 2; i < cells + 2; i++) bins->start[i] += bins->start[i - 1];
  }
  for (size_t c = 0; c < columns->clusters; c++)
    for (int a = 0; a < 3; a++)
      if (columns->boxes[c].half[a] > bins->half_max[a])
        bins->half_max[a] = columns->boxes[c].half[a];
cleanup:
  return status;
}

struct found {
  uint64_t *key; /* image << 32 | cluster */
  size_t n, capacity;
};

static enum status found_push(struct found *found, uint64_t key) {
  enum status status = STATUS_OK;
  if (found->n == found->capacity) {
    size_t capacity = found->capacity == 0 ? 256 : 2 * found->capacity;
    TRY(memory_resize(&found->key, capacity, sizeof *found->key, "neighbour clusters"));
    found->capacity = capacity;
  }
  found->key[found->n++] = key;
cleanup:
  return status;
}

/* Cells come in ascending order and so do their members: a few long runs, for which insertion
 * from the back is quick. */
static void found_sort(struct found *found) {
  for (size_t i = 1; i < found->n; i++) {
    uint64_t key = found->key[i];
    size_t j = i;
    for (; j > 0 && found->key[j - 1] > key; j--) found->key[j] = found->key[j - 1];
    found->key[j] = key;
  }
}

/* All column clusters and images within range of one row. */
static enum status search_row(const struct frame *frame, const struct bins *bins,
                              const struct cluster_set *columns, const struct cluster_box *row,
                              double range, struct found *found) {
  enum status status = STATUS_OK;
  int64_t low[3], high[3];
  for (int a = 0; a < 3; a++) {
    double cell = frame->length[a] / bins->cells[a];
    double around = range + (double)row->half[a] + (double)bins->half_max[a];
    /* The row's own centre may lie in an image; only differences matter, so start from its fold. */
    double at = frame->unit[a] * (double)row->centre[a];
    low[a] = (int64_t)floor((at - around) / cell);
    high[a] = (int64_t)floor((at + around) / cell);
    int64_t all = (int64_t)bins->cells[a] << frame->image_bits[a];
    if (high[a] - low[a] + 1 > all) high[a] = low[a] + all - 1;
    if (frame->step[a] == 0) low[a] = high[a] = 0;
  }
  float limit = (float)(range * range), unit[3];
  for (int a = 0; a < 3; a++) unit[a] = (float)frame->unit[a];
  found->n = 0;
  for (int64_t k = low[2]; k <= high[2]; k++) {
    for (int64_t j = low[1]; j <= high[1]; j++) {
      for (int64_t i = low[0]; i <= high[0]; i++) {
        int64_t at[3] = {i, j, k};
        uint32_t which[3];
        size_t cell[3];
        for (int a = 0; a < 3; a++) {
          int64_t n = bins->cells[a], box = at[a] >= 0 ? at[a] / n : -((n - 1 - at[a]) / n);
          cell[a] = (size_t)(at[a] - box * n);
          which[a] = (uint32_t)box;
        }
        size_t c = (cell[2] * (size_t)bins->cells[1] + cell[1]) * (size_t)bins->cells[0] + cell[0];
        for (uint32_t m = bins->start[c]; m < bins->start[c + 1]; m++) {
          const struct cluster_box *box = &columns->boxes[bins->member[m]];
          uint32_t offset[3] = {0}, image = 0;
          for (int a = 0; a < 3; a++) {
            /* The column's centre may itself lie in an image of the cell. */
            int bits = frame->image_bits[a];
            if (bits == 0) continue;
            uint32_t own = (which[a] - (box->centre[a] >> (32 - bits))) & ((1u << bits) - 1);
            offset[a] = own << (32 - bits);
            image |= own << (RUN_IMAGE_BITS * a);
          }
          float sum = 0;
          for (int a = 0; a < 3; a++) {
            float d = (float)(int32_t)(box->centre[a] + offset[a] - row->centre[a]) * unit[a];
            float gap = fabsf(d) - box->half[a] - row->half[a];
            if (gap > 0) sum += gap * gap;
          }
          if (sum < limit) TRY(found_push(found, (uint64_t)image << 32 | bins->member[m]));
        }
      }
    }
  }
cleanup:
  return status;
}

static enum status chunk_push(struct list_chunk *chunk, uint32_t entry) {
  enum status status = STATUS_OK;
  if (chunk->used == chunk->capacity) {
    size_t capacity = chunk->capacity + chunk->capacity / 4 + 256;
    TRY(memory_resize(&chunk->entries, capacity, sizeof *chunk->entries, "neighbour lists"));
    chunk->capacity = capacity;
  }
  chunk->entries[chunk->used++] = entry;
cleanup:
  return status;
}

static enum status encode_row(const struct found *found, struct list_chunk *chunk) {
  enum status status = STATUS_OK;
  uint32_t image = 0;
  for (size_t i = 0; i < found->n;) {
    uint32_t own = (uint32_t)(found->key[i] >> 32), start = (uint32_t)found->key[i], n = 1;
    while (n < RUN_MAX && i + n < found->n && found->key[i + n] == found->key[i] + n) n++;
    if (own != image) TRY(chunk_push(chunk, RUN_IMAGE | own));
    image = own;
    TRY(chunk_push(chunk, (n - 1) << RUN_START_BITS | start));
    i += n;
  }
cleanup:
  return status;
}

enum status neighbours_build(const struct frame *frame, const struct cluster_set *rows,
                             const struct cluster_set *columns, double range,
                             struct neighbour_list *list) {
  enum status status = STATUS_OK;
  struct bins bins = {0};
  if (columns->clusters >> RUN_START_BITS != 0)
    TRY_FAIL(STATUS_RUN, "%zu clusters are more than a neighbour list can name", columns->clusters);
  if (list->rows != rows->clusters) {
    memory_free(&list->start);
    TRY(memory_allocate(&list->start, rows->clusters + 1, sizeof *list->start, "neighbour lists"));
    list->rows = rows->clusters;
  }
  if (rows->clusters == 0) goto cleanup;
  TRY(bins_make(frame, columns, range, &bins));
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t chunk = 0; chunk < LIST_CHUNKS; chunk++) {
    struct found found = {0};
    struct list_chunk *to = &list->chunks[chunk];
    enum status failed = STATUS_OK;
    to->used = 0;
    size_t end = list_chunk_begin(list, chunk + 1);
    for (size_t r = list_chunk_begin(list, chunk); r < end && failed == STATUS_OK; r++) {
      list->start[r] = (uint32_t)to->used;
      failed = search_row(frame, &bins, columns, &rows->boxes[r], range, &found);
      found_sort(&found);
      if (failed == STATUS_OK) failed = encode_row(&found, to);
    }
    memory_free(&found.key);
    if (failed != STATUS_OK) {
#pragma omp atomic write
      status = failed;
    }
  }
cleanup:
  memory_free(&bins.start);
  memory_free(&bins.member);
  return status;
}

void neighbours_free(struct neighbour_list *list) {
  memory_free(&list->start);
  for (size_t c = 0; c < LIST_CHUNKS; c++) memory_free(&list->chunks[c].entries);
  memset(list, 0, sizeof *list);
}

size_t neighbours_bytes(const struct neighbour_list *list) {
  size_t bytes = list->rows * sizeof *list->start;
  for (size_t c = 0; c < LIST_CHUNKS; c++)
    bytes += list->chunks[c].capacity * sizeof *list->chunks[c].entries;
  return bytes;
}
