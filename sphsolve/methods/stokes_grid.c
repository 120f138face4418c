#include "sphsolve/methods/stokes_grid.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/memory.h"

/* A flood through the fluid over voxel faces that remembers how often it has gone around the box.
 * Where it meets itself with another count there is a path around: `flows` if that path's closing
 * vector has a component along the force. */
struct flood {
  const struct lattice *lattice;
  double closing_work[3]; /* driving times the length of the box */
  uint8_t *label;         /* per site: 0 unvisited, 1 visited */
  int16_t (*turns)[3];    /* per site */
  size_t *queue;
};

static bool work_is_done(const struct flood *flood, const int turns[3]) {
  double work = 0.0, scale = 0.0;
  for (int a = 0; a < 3; a++) {
    work += flood->closing_work[a] * turns[a];
    scale += fabs(flood->closing_work[a] * turns[a]);
  }
  return fabs(work) > 1e-9 * scale;
}

/* Floods the pore of `seed`; the sites are left in queue[0..count). */
static bool flood_pore(struct flood *flood, size_t seed, size_t *count) {
  const struct lattice *l = flood->lattice;
  const size_t step[3] = {1, l->size[0], l->size[0] * l->size[1]};
  bool flows = false;
  size_t head = 0, tail = 0;
  flood->queue[tail++] = seed;
  flood->label[seed] = 1;
  memset(flood->turns[seed], 0, sizeof flood->turns[seed]);
  while (head < tail) {
    const size_t site = flood->queue[head++];
    const size_t at[3] = {site % l->size[0], site / step[1] % l->size[1], site / step[2]};
    for (int a = 0; a < 3; a++)
      for (int side = -1; side <= 1; side += 2) {
        int turns[3] = {flood->turns[site][0], flood->turns[site][1], flood->turns[site][2]};
        size_t next = site;
        if (side > 0 && at[a] + 1 == l->size[a])
          next -= at[a] * step[a], turns[a]++;
        else if (side < 0 && at[a] == 0)
          next += (l->size[a] - 1) * step[a], turns[a]--;
        else
          next = side > 0 ? site + step[a] : site - step[a];
        if (l->kind[next] != SITE_FLUID) continue;
        if (!flood->label[next]) {
          flood->label[next] = 1;
          for (int b = 0; b < 3; b++) flood->turns[next][b] = (int16_t)turns[b];
          flood->queue[tail++] = next;
          continue;
        }
        for (int b = 0; b < 3; b++) turns[b] -= flood->turns[next][b];
        if (!flows && (turns[0] || turns[1] || turns[2])) flows = work_is_done(flood, turns);
      }
  }
  *count = tail;
  return flows;
}

static void mark(struct stokes_grid *grid, size_t site) {
  const size_t row = site / grid->size[0], i = site % grid->size[0];
  grid->mask[row * grid->chunks + i / STOKES_LANES] |= (uint16_t)(1u << i % STOKES_LANES);
}

static enum status mark_flowing(const struct lattice *lattice, const double driving[3],
                                struct stokes_grid *grid) {
  enum status status = STATUS_OK;
  struct flood flood = {.lattice = lattice};
  for (int a = 0; a < 3; a++)
    flood.closing_work[a] = driving[a] * (double)lattice->size[a] * lattice->spacing[a];
  TRY(memory_allocate(&flood.label, lattice->count, 1, "labels of the pores"));
  TRY(memory_allocate(&flood.turns, lattice->count, sizeof *flood.turns, "paths in the pores"));
  TRY(memory_allocate(&flood.queue, lattice->fluid_count, sizeof *flood.queue, "pore queue"));
  for (size_t s = 0; s < lattice->count; s++) {
    if (lattice->kind[s] != SITE_FLUID || flood.label[s]) continue;
    size_t count;
    if (flood_pore(&flood, s, &count))
      for (size_t q = 0; q < count; q++) mark(grid, flood.queue[q]);
  }
cleanup:
  memory_free(&flood.label);
  memory_free(&flood.turns);
  memory_free(&flood.queue);
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
  grid->active = grid->active_all = grid->row_start[grid->rows];
  grid->row_end = grid->inner_end = grid->rows;
  return STATUS_OK;
cleanup:
  stokes_grid_free(grid);
  return status;
}

/* Work of a plane, in units of that of a solved site; docs/scaling.md. */
#define WORK_SITE 0.2

enum status stokes_grid_share(struct stokes_grid *grid, int reach) {
  enum status status = STATUS_OK;
  const size_t planes = grid->size[2], ny = grid->size[1];
  double *work = NULL;
  if (ranks_count() == 1) return STATUS_OK;
  TRY(memory_allocate(&work, planes, sizeof *work, "work of the planes"));
  for (size_t k = 0; k < planes; k++)
    work[k] = (double)(grid->row_start[(k + 1) * ny] - grid->row_start[k * ny]) +
              WORK_SITE * (double)(grid->size[0] * ny);
  /* A slab is as thick as the ghosts on both sides of it, and whole blocks of the coarse levels. */
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
  memory_free(&grid->mask);
  memory_free(&grid->row_start);
  slabs_free(&grid->slabs);
}
