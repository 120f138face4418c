#include "sphsolve/stokes/solver/grid.h"
#include "sphsolve/stokes/constants.h"

#include <stdbool.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/geometry/percolation.h"
#include "sphsolve/geometry/resample.h"

static void mark(struct stokes_grid *grid, size_t site) {
  const size_t row = site / grid->size[0], i = site % grid->size[0];
  grid->mask[row * grid->chunks + i / STOKES_LANES] |= (uint16_t)(1u << i % STOKES_LANES);
}

static enum status mark_flowing(const struct lattice *lattice, const double driving[3],
                                struct stokes_grid *grid) {
  enum status status = STATUS_OK;
  uint8_t *flowing = NULL;
  bool flows;
  TRY(memory_allocate(&flowing, lattice->count, 1, "labels of the pores"));
  TRY(percolation_find(lattice, driving, false, flowing, &flows));
  for (size_t s = 0; s < lattice->count; s++)
    if (flowing[s] == PERCOLATION_FLOWS) mark(grid, s);
cleanup:
  memory_free(&flowing);
  return status;
}

enum status stokes_grid_build(const struct lattice *lattice, const double driving[3], int keep_all,
                              struct stokes_grid *grid) {
  enum status status = STATUS_OK;
  memset(grid, 0, sizeof *grid);
  memcpy(grid->size, lattice->size, sizeof grid->size);
  grid->rows = grid->size[1] * grid->size[2];
  grid->chunks = (grid->size[0] + STOKES_LANES - 1) / STOKES_LANES;
  grid->stride = grid->chunks * STOKES_LANES;
  TRY(memory_allocate(&grid->mask, grid->rows * grid->chunks, sizeof *grid->mask, "pore mask"));
  TRY(memory_allocate(&grid->row_start, grid->rows + 1, sizeof *grid->row_start, "pore rows"));
  if (keep_all) {
    for (size_t s = 0; s < lattice->count; s++)
      if (lattice->kind[s] == SITE_FLUID) mark(grid, s);
  } else {
    TRY(mark_flowing(lattice, driving, grid));
  }
  for (size_t row = 0; row < grid->rows; row++) {
    size_t count = 0;
    for (size_t c = 0; c < grid->chunks; c++)
      count += (size_t)__builtin_popcount(grid->mask[row * grid->chunks + c]);
    grid->row_start[row + 1] = grid->row_start[row] + count;
  }
  grid->active = grid->active_all = grid->flowing = grid->row_start[grid->rows];
  grid->row_end = grid->inner_end = grid->rows;
  grid->columns = grid->size[1];
  return STATUS_OK;
cleanup:
  stokes_grid_free(grid);
  return status;
}

/* Restricts the grid to the rows before the mirror plane in y of each plane. */
static void halve(struct stokes_grid *grid) {
  size_t packed = 0, taken = 0;
  grid->columns = grid->size[1] / 2;
  for (size_t row = 0; row < grid->rows; row++) {
    const size_t count = grid->row_start[row + 1] - taken;
    taken = grid->row_start[row + 1];
    packed += stokes_grid_is_y_image(grid, row) ? 0 : count;
    grid->row_start[row + 1] = packed;
  }
}

void stokes_grid_mirror(struct stokes_grid *grid, const struct lattice *lattice,
                        const double driving[3], int reach) {
  const size_t ny = grid->size[1], nz = grid->size[2], least = 4 * (size_t)reach + 2;
  int along = -1, axes = 0;
  for (int a = 0; a < 3; a++)
    if (driving[a] != 0.0) {
      along = a;
      axes++;
    }
  if (ranks_count() > 1 || axes != 1 || lattice->dimensions != 3) return;
  grid->images = reach;
  if (lattice->y_mirrored && along != 1 && ny >= least && lattice->micro_porosity == NULL)
    halve(grid);
  grid->mirrored = nz >= least && lattice_is_mirrored(lattice);
  const size_t planes = grid->mirrored ? (nz + 1) / 2 : nz;
  /* The mirror image of a flow is the flow under the mirrored force: a force along z changes its
   * sign, and with it all fields; velocities along z change sign once more. */
  const float force = along == 2 ? -1.0f : 1.0f;
  for (int c = 0; c < 4; c++) grid->parity[c] = c == 2 ? -force : force;
  grid->row_end = grid->inner_end = planes * ny;
  grid->active = grid->active_all = grid->row_start[grid->row_end];
}

enum status stokes_grid_distribute(struct stokes_grid *grid, int reach) {
  enum status status = STATUS_OK;
  const size_t planes = grid->size[2], ny = grid->size[1];
  double *work = NULL;
  if (ranks_count() == 1) return STATUS_OK;
  TRY(memory_allocate(&work, planes, sizeof *work, "work of the planes"));
  for (size_t k = 0; k < planes; k++)
    work[k] = (double)(grid->row_start[(k + 1) * ny] - grid->row_start[k * ny]) +
              WORK_SITE * (double)(grid->size[0] * ny);
  /* A slab is at least as thick as the ghosts on both sides together, and consists of whole blocks
   * of the coarse levels. */
  const size_t blocks = (size_t)1 << STOKES_SHARED_LEVELS;
  const size_t unit = (2 * (size_t)reach + blocks - 1) / blocks * blocks;
  TRY(slabs_make(planes, work, unit, &grid->slabs));
  const struct slabs *s = &grid->slabs;
  grid->row_begin = s->begin * ny;
  grid->row_end = s->end * ny;
  grid->reach = s->count > 1 && s->begin < s->end ? reach : 0;
  grid->inner_begin = grid->row_begin + (size_t)grid->reach * ny;
  grid->inner_end = grid->row_end - (size_t)grid->reach * ny;
  grid->offset = grid->row_start[grid->row_begin];
  grid->active = grid->row_start[grid->row_end] - grid->offset;
  for (size_t row = grid->row_begin; row <= grid->row_end; row++)
    grid->row_start[row] -= grid->offset;
cleanup:
  memory_free(&work);
  return status;
}

void stokes_grid_free(struct stokes_grid *grid) {
  MEMORY_FREE(&grid->mask, &grid->row_start);
  slabs_free(&grid->slabs);
}
