#include "ct2model/model/connect.h"

#include <string.h>

#include "common/memory.h"

/* Union-find over runs. shift: the periodic image of this run, in periods, that is connected to
 * image 0 of its parent. */
struct forest {
  uint32_t *parent;
  int16_t (*shift)[3];
  uint8_t *wraps; /* of roots: bit d is set if the part meets its own image along d */
};

static uint32_t find_root(struct forest *forest, uint32_t run, int shift[3]) {
  uint32_t root = run;
  int total[3] = {0, 0, 0};
  while (forest->parent[root] != root) {
    for (int d = 0; d < 3; d++) total[d] += forest->shift[root][d];
    root = forest->parent[root];
  }
  memcpy(shift, total, sizeof total);
  while (forest->parent[run] != root && run != root) { /* path compression */
    uint32_t next = forest->parent[run];
    int step[3];
    for (int d = 0; d < 3; d++) {
      step[d] = forest->shift[run][d];
      forest->shift[run][d] = (int16_t)total[d];
      total[d] -= step[d];
    }
    forest->parent[run] = root;
    run = next;
  }
  return root;
}

/* Run a touches run b, whose image is `step` periods further along `axis`. */
static void join_runs(struct forest *forest, uint32_t a, uint32_t b, int axis, int step) {
  int to_a[3], to_b[3];
  uint32_t root_a = find_root(forest, a, to_a), root_b = find_root(forest, b, to_b);
  int gap[3];
  for (int d = 0; d < 3; d++) gap[d] = to_a[d] - to_b[d] + (d == axis ? step : 0);
  if (root_a == root_b) {
    for (int d = 0; d < 3; d++)
      if (gap[d] != 0) forest->wraps[root_a] |= (uint8_t)(1u << d);
    return;
  }
  /* The run with the smaller number is the root, so that parts are numbered in the order in which
   * they are met. */
  if (root_a > root_b) {
    uint32_t swap = root_a;
    root_a = root_b;
    root_b = swap;
    for (int d = 0; d < 3; d++) gap[d] = -gap[d];
  }
  forest->parent[root_b] = root_a;
  for (int d = 0; d < 3; d++) forest->shift[root_b][d] = (int16_t)gap[d];
  forest->wraps[root_a] |= forest->wraps[root_b];
}

static size_t row_runs(const uint8_t *row, size_t nx, uint8_t value, struct run *runs) {
  size_t n = 0;
  for (size_t x = 0; x < nx;) {
    if (row[x] != value) {
      x++;
      continue;
    }
    size_t x0 = x;
    while (x < nx && row[x] == value) x++;
    if (runs != NULL) runs[n] = (struct run){(uint32_t)x0, (uint32_t)x, 0};
    n++;
  }
  return n;
}

static void join_rows(struct forest *forest, const struct parts *parts, size_t row_a, size_t row_b,
                      int axis, int step) {
  size_t a = parts->row_first[row_a], a_end = parts->row_first[row_a + 1];
  size_t b = parts->row_first[row_b], b_end = parts->row_first[row_b + 1];
  while (a < a_end && b < b_end) {
    const struct run *ra = &parts->runs[a], *rb = &parts->runs[b];
    if (ra->x0 < rb->x1 && rb->x0 < ra->x1) join_runs(forest, (uint32_t)a, (uint32_t)b, axis, step);
    if (ra->x1 < rb->x1)
      a++;
    else
      b++;
  }
}

static enum status collect_runs(const uint8_t *image, uint8_t value, struct parts *parts) {
  enum status status = STATUS_OK;
  size_t nx = parts->size[0], rows = parts->size[1] * parts->size[2];
  TRY(memory_allocate(&parts->row_first, rows + 1, sizeof *parts->row_first, "rows of runs"));
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < rows; row++)
    parts->row_first[row + 1] = row_runs(image + row * nx, nx, value, NULL);
  for (size_t row = 0; row < rows; row++) parts->row_first[row + 1] += parts->row_first[row];
  parts->run_count = parts->row_first[rows];
  if (parts->run_count > UINT32_MAX) TRY_FAIL(STATUS_RUN, "too many runs to label");
  TRY(memory_allocate(&parts->runs, parts->run_count, sizeof *parts->runs, "runs of voxels"));
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < rows; row++)
    (void)row_runs(image + row * nx, nx, value, parts->runs + parts->row_first[row]);
cleanup:
  return status;
}

static void join_all(struct forest *forest, const struct parts *parts, const bool periodic[3]) {
  size_t nx = parts->size[0], ny = parts->size[1], nz = parts->size[2];
  for (size_t z = 0; z < nz; z++) {
    for (size_t y = 0; y < ny; y++) {
      size_t row = z * ny + y;
      if (y > 0) join_rows(forest, parts, row - 1, row, 1, 0);
      if (z > 0) join_rows(forest, parts, row - ny, row, 2, 0);
      if (periodic[1] && y == ny - 1) join_rows(forest, parts, row, z * ny, 1, 1);
      if (periodic[2] && z == nz - 1) join_rows(forest, parts, row, y, 2, 1);
      size_t first = parts->row_first[row], end = parts->row_first[row + 1];
      if (periodic[0] && first < end && parts->runs[first].x0 == 0 && parts->runs[end - 1].x1 == nx)
        join_runs(forest, (uint32_t)(end - 1), (uint32_t)first, 0, 1);
    }
  }
}

static void measure_parts(struct parts *parts, const bool periodic[3]) {
  size_t nx = parts->size[0], ny = parts->size[1], nz = parts->size[2];
  for (size_t z = 0; z < nz; z++) {
    for (size_t y = 0; y < ny; y++) {
      size_t row = z * ny + y;
      for (size_t r = parts->row_first[row]; r < parts->row_first[row + 1]; r++) {
        const struct run *run = &parts->runs[r];
        struct part *part = &parts->parts[run->part];
        part->voxels += run->x1 - run->x0;
        part->at_border |= (!periodic[0] && (run->x0 == 0 || run->x1 == nx)) ||
                           (!periodic[1] && (y == 0 || y == ny - 1)) ||
                           (!periodic[2] && (z == 0 || z == nz - 1));
      }
    }
  }
}

/* In a direction that is not periodic, a part percolates when it touches both ends. */
static enum status mark_end_to_end(struct parts *parts, const bool periodic[3]) {
  enum status status = STATUS_OK;
  uint8_t *ends = NULL;
  size_t nx = parts->size[0], ny = parts->size[1], nz = parts->size[2];
  TRY(memory_allocate(&ends, parts->count, 1, "ends of parts"));
  for (size_t z = 0; z < nz; z++) {
    for (size_t y = 0; y < ny; y++) {
      size_t row = z * ny + y;
      for (size_t r = parts->row_first[row]; r < parts->row_first[row + 1]; r++) {
        const struct run *run = &parts->runs[r];
        ends[run->part] |= (uint8_t)((run->x0 == 0) | (run->x1 == nx) << 1 | (y == 0) << 2 |
                                     (y == ny - 1) << 3 | (z == 0) << 4 | (z == nz - 1) << 5);
      }
    }
  }
  for (size_t p = 0; p < parts->count; p++) {
    for (int d = 0; d < 3; d++) {
      if (!periodic[d]) parts->parts[p].percolates[d] = (ends[p] >> 2 * d & 3) == 3;
    }
  }
cleanup:
  memory_free(&ends);
  return status;
}

enum status parts_find(const uint8_t *image, const size_t size[3], const bool periodic[3],
                       uint8_t value, struct parts *parts) {
  enum status status = STATUS_OK;
  struct forest forest = {0};
  memset(parts, 0, sizeof *parts);
  memcpy(parts->size, size, sizeof parts->size);
  TRY(collect_runs(image, value, parts));
  size_t n = parts->run_count;
  TRY(memory_allocate(&forest.parent, n, sizeof *forest.parent, "labels"));
  TRY(memory_allocate(&forest.shift, n, sizeof *forest.shift, "labels"));
  TRY(memory_allocate(&forest.wraps, n, sizeof *forest.wraps, "labels"));
  for (size_t i = 0; i < n; i++) forest.parent[i] = (uint32_t)i;
  join_all(&forest, parts, periodic);
  /* A root is the first run of its part, so that it is met before the others. */
  for (size_t i = 0; i < n; i++) {
    int shift[3];
    uint32_t root = find_root(&forest, (uint32_t)i, shift);
    parts->runs[i].part = root == i ? (uint32_t)parts->count++ : parts->runs[root].part;
  }
  TRY(memory_allocate(&parts->parts, parts->count, sizeof *parts->parts, "parts"));
  for (size_t i = 0; i < n; i++) {
    if (forest.parent[i] != i) continue;
    for (int d = 0; d < 3; d++)
      parts->parts[parts->runs[i].part].percolates[d] = (forest.wraps[i] >> d & 1) != 0;
  }
  measure_parts(parts, periodic);
  TRY(mark_end_to_end(parts, periodic));
cleanup:
  MEMORY_FREE(&forest.parent, &forest.shift, &forest.wraps);
  if (status != STATUS_OK) parts_end(parts);
  return status;
}

void parts_end(struct parts *parts) {
  MEMORY_FREE(&parts->runs, &parts->row_first, &parts->parts);
  parts->count = parts->run_count = 0;
}

size_t parts_paint(const struct parts *parts, bool (*choose)(const struct part *, const void *),
                   const void *context, uint8_t value, uint8_t *image) {
  size_t rows = parts->size[1] * parts->size[2], painted = 0;
  for (size_t row = 0; row < rows; row++) {
    for (size_t r = parts->row_first[row]; r < parts->row_first[row + 1]; r++) {
      const struct run *run = &parts->runs[r];
      if (!choose(&parts->parts[run->part], context)) continue;
      memset(image + row * parts->size[0] + run->x0, value, run->x1 - run->x0);
      painted += run->x1 - run->x0;
    }
  }
  return painted;
}
