#include "sphsolve/stokes/solver/cuts.h"

#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"

/* One end of a cut link, and the row it belongs to. */
struct end {
  size_t row;
  struct stokes_cut cut;
};

struct ends {
  struct end *end;
  size_t count, room;
};

static enum status add_end(struct ends *ends, const struct stokes_operator *op, size_t row,
                           uint32_t at, uint32_t offset, size_t other,
                           const struct thin_wall_side *face) {
  if (ends->count == ends->room) {
    const size_t room = ends->room ? 2 * ends->room : 256;
    const enum status status =
        memory_resize(&ends->end, room, sizeof *ends->end, "walls between sites");
    if (status != STATUS_OK) return status;
    ends->room = room;
  }
  ends->end[ends->count++] = (struct end){
      .row = row,
      .cut = {.at = at,
              .offset = offset,
              .other = other,
              .before = (float)(face->before / op->stencil->unit),
              .behind = (float)(face->behind / op->stencil->unit),
              .normal = {(float)face->normal[0], (float)face->normal[1], (float)face->normal[2]}}};
  return STATUS_OK;
}

/* Index of an active site in its packed row. */
static uint32_t packed_index(const struct stokes_grid *grid, size_t row, size_t i) {
  const uint16_t *mask = grid->mask + row * grid->chunks;
  unsigned before =
      (unsigned)__builtin_popcount(mask[i / STOKES_LANES] & ((1U << i % STOKES_LANES) - 1U));
  for (size_t c = 0; c < i / STOKES_LANES; c++) before += (unsigned)__builtin_popcount(mask[c]);
  return before;
}

/* Whether a row is solved by this rank. */
static bool is_solved(const struct stokes_grid *grid, size_t row) {
  return row >= stokes_grid_begin(grid) && row < stokes_grid_end(grid) &&
         !stokes_grid_is_y_image(grid, row);
}

/* Adds the cut links of a row. A link between two solved sites is followed once, from the site that
 * comes first in the stencil, and added for both. */
static enum status find_row(const struct stokes_operator *op, size_t row, struct ends *ends) {
  enum status status = STATUS_OK;
  const struct stokes_grid *grid = op->grid;
  const struct stokes_stencil *stencil = op->stencil;
  const size_t nx = grid->size[0];
  uint32_t packed = 0;
  for (size_t i = 0; i < nx; i++) {
    if (!stokes_grid_is_active(grid, row, i)) continue;
    const size_t at[3] = {i, row % grid->size[1], row / grid->size[1]};
    for (int o = 0; o < stencil->offset_count; o++) {
      const int *step = stencil->offsets[o].step;
      const size_t other = stokes_grid_row(grid, at[1], at[2], step[1], step[2]);
      const long to = ((long)i + step[0]) % (long)nx;
      const size_t x = (size_t)(to < 0 ? to + (long)nx : to);
      struct thin_wall_side near, far;
      if (op->lattice->kind[other * nx + x] != SITE_FLUID) continue;
      const bool both = is_solved(grid, other) && stokes_grid_is_active(grid, other, x);
      /* The offsets are symmetric: the opposite of o is as far from the end of the list. */
      const int opposite = stencil->offset_count - 1 - o;
      if ((both && opposite < o) || thin_wall_open_box(op->lattice, at, step) ||
          !thin_wall_cuts(op->lattice, at, step, &near, &far))
        continue;
      TRY(add_end(ends, op, row, packed, (uint32_t)o, other * grid->stride + x, &near));
      if (both)
        TRY(add_end(ends, op, other, packed_index(grid, other, x), (uint32_t)opposite,
                    row * grid->stride + i, &far));
    }
    packed++;
  }
cleanup:
  return status;
}

static int by_place(const void *a, const void *b) {
  const struct end *p = a, *q = b;
  if (p->row != q->row) return p->row < q->row ? -1 : 1;
  if (p->cut.at != q->cut.at) return p->cut.at < q->cut.at ? -1 : 1;
  return p->cut.offset == q->cut.offset ? 0 : p->cut.offset < q->cut.offset ? -1 : 1;
}

/* Joins the lists of the threads, in the order of the sites: the same for any number of threads. */
static enum status join(struct stokes_operator *op, struct ends *of_thread) {
  enum status status = STATUS_OK;
  struct ends all = {0};
  for (int t = 0; t < op->threads; t++) all.count += of_thread[t].count;
  if (all.count == 0) return STATUS_OK;
  TRY(memory_allocate(&all.end, all.count, sizeof *all.end, "walls between sites"));
  for (int t = 0; t < op->threads; t++) {
    if (of_thread[t].count > 0)
      memcpy(all.end + all.room, of_thread[t].end, of_thread[t].count * sizeof *all.end);
    all.room += of_thread[t].count;
    memory_free(&of_thread[t].end);
  }
  qsort(all.end, all.count, sizeof *all.end, by_place);
  TRY(memory_allocate(&op->cuts, all.count, sizeof *op->cuts, "walls between sites"));
  TRY(memory_allocate(&op->cut_start, op->grid->rows + 1, sizeof *op->cut_start,
                      "walls between sites"));
  for (size_t c = 0; c < all.count; c++) {
    op->cuts[c] = all.end[c].cut;
    op->cut_start[all.end[c].row + 1]++;
  }
  for (size_t row = 0; row < op->grid->rows; row++) op->cut_start[row + 1] += op->cut_start[row];
cleanup:
  memory_free(&all.end);
  return status;
}

enum status stokes_cuts_build(struct stokes_operator *op) {
  enum status status = STATUS_OK;
  const struct stokes_grid *grid = op->grid;
  struct ends *of_thread = NULL;
  if (op->lattice->wall_distance == NULL) return STATUS_OK;
  TRY(memory_allocate(&of_thread, (size_t)op->threads, sizeof *of_thread, "walls between sites"));
  enum status failed = STATUS_OK;
#pragma omp parallel for schedule(dynamic, 16) num_threads(op->threads)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    if (stokes_grid_is_y_image(grid, row) || interrupt_alone()) continue;
    const enum status found = find_row(op, row, &of_thread[omp_get_thread_num()]);
#pragma omp critical(stokes_cuts)
    if (found != STATUS_OK) failed = found;
  }
  TRY(interrupt_look());
  TRY(failed);
  TRY(join(op, of_thread));
cleanup:
  for (int t = 0; of_thread && t < op->threads; t++) memory_free(&of_thread[t].end);
  memory_free(&of_thread);
  return status;
}

size_t stokes_cuts_of(const struct stokes_operator *op, size_t row, size_t at, size_t *end) {
  *end = 0;
  if (op->cuts == NULL) return 0;
  size_t low = op->cut_start[row], high = op->cut_start[row + 1];
  while (low < high) {
    const size_t middle = low + (high - low) / 2;
    if (op->cuts[middle].at < at)
      low = middle + 1;
    else
      high = middle;
  }
  *end = low;
  while (*end < op->cut_start[row + 1] && op->cuts[*end].at == at) (*end)++;
  return low;
}

const struct stokes_cut *stokes_cut_beside(const struct stokes_operator *op, size_t row,
                                           size_t packed, int axis, bool up) {
  size_t end;
  for (size_t c = stokes_cuts_of(op, row, packed, &end); c < end; c++) {
    const int *step = op->stencil->offsets[op->cuts[c].offset].step;
    if (step[axis] == (up ? 1 : -1) &&
        step[0] * step[0] + step[1] * step[1] + step[2] * step[2] == 1)
      return &op->cuts[c];
  }
  return NULL;
}

/* Coefficient of a convolution at an offset. */
static double coefficient(const struct stokes_operator *op,
                          const struct stokes_convolution *convolution, uint32_t offset) {
  const struct stokes_offset *o = &op->stencil->offsets[offset];
  return convolution == &op->stencil->laplace ? o->viscous
                                              : o->gradient[convolution - op->stencil->gradient];
}

void stokes_cuts_subtract(const struct stokes_operator *op,
                          const struct stokes_convolution *convolution, size_t row,
                          const float *field, float *sum) {
  if (op->cuts == NULL) return;
  for (size_t c = op->cut_start[row]; c < op->cut_start[row + 1]; c++) {
    const struct stokes_cut *cut = &op->cuts[c];
    sum[cut->at] -= (float)coefficient(op, convolution, cut->offset) * field[cut->other];
  }
}

void stokes_cuts_subtract_double(const struct stokes_operator *op,
                                 const struct stokes_convolution *convolution, size_t row,
                                 const double *field, double *sum) {
  if (op->cuts == NULL) return;
  for (size_t c = op->cut_start[row]; c < op->cut_start[row + 1]; c++) {
    const struct stokes_cut *cut = &op->cuts[c];
    sum[cut->at] -= coefficient(op, convolution, cut->offset) * field[cut->other];
  }
}
