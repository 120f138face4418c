/* Sites on which method stokes solves, and their storage: vectors are packed (active sites only, x
 * fastest); stencils read full rows, for which one field at a time is unpacked. */
#ifndef TOSUI_SPHSOLVE_STOKES_GRID_H
#define TOSUI_SPHSOLVE_STOKES_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/ranks.h"
#include "common/slabs.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/stokes/solver/rows.h"

/* Slabs are whole blocks of 2^STOKES_SHARED_LEVELS planes: this number of levels, including the
 * lattice, is divided among the ranks; every rank has all of the coarser ones (1/64 of the
 * sites). */
#define STOKES_SHARED_LEVELS 2

struct stokes_grid {
  size_t size[3];
  size_t rows;           /* size[1] * size[2]; row (j, k) has number k * size[1] + j */
  size_t chunks, stride; /* per row: STOKES_LANES floats a chunk, stride = STOKES_LANES * chunks */
  size_t active;         /* sites solved by this rank */
  size_t active_all;     /* sites solved by all ranks */
  size_t flowing;        /* sites they represent: twice as many where half is solved */
  size_t offset;         /* sites solved by the preceding ranks */
  size_t row_begin, row_end;     /* rows of this rank */
  size_t inner_begin, inner_end; /* those of them whose stencil reads no ghost */
  int reach;                     /* planes of ghosts on each side; 0: none */
  /* A lattice that is its own mirror image in z, driven along one axis, is solved on its lower
   * half: rows up to row_end. Fields are even or odd there (+1, -1: velocities x, y, z and
   * pressure), and the rows beyond row_end are images of rows within. */
  bool mirrored;
  float parity[4];
  /* The same in y, if the lattice is symmetric in y: only the first `columns` of the size[1] rows
   * of each plane are solved. Velocities along y are odd there, all else is even. */
  size_t columns;
  int images; /* planes of images on each side that a stencil reads */
  struct slabs slabs;
  uint16_t *mask;    /* [rows][chunks]: bit b of chunk c is site c * STOKES_LANES + b */
  size_t *row_start; /* [rows + 1]: first packed index of a row of this rank */
};

/* Marks the fluid sites through which fluid can flow: those of face-connected pores that lead
 * around the periodic box in a direction along which `driving` does work. In all others pressure
 * balances the body force. `keep_all`: walls move, and every pore may flow. */
enum status stokes_grid_build(const struct lattice *lattice, const double driving[3], int keep_all,
                              struct stokes_grid *grid);
/* Restricts the grid to the lower half along z, y or both, where lattice and flow are
 * mirror-symmetric and a single rank has all of it. `reach` as below. */
void stokes_grid_mirror(struct stokes_grid *grid, const struct lattice *lattice,
                        const double driving[3], int reach);
/* Divides the rows among the ranks; `reach`: planes that a stencil reads on each side. Does nothing
 * for one rank. */
enum status stokes_grid_distribute(struct stokes_grid *grid, int reach);
void stokes_grid_free(struct stokes_grid *grid);

/* Loops over the rows of a rank run in two parts: first the rows that read no ghost, during the
 * exchange of ghosts, then the others. */
#define STOKES_PARTS (RANKS ? 2 : 1)
static inline size_t stokes_grid_part(const struct stokes_grid *grid, int part) {
  if (!RANKS) return grid->row_end;
  const size_t inner = grid->inner_end - grid->inner_begin;
  return part == 0 ? inner : grid->row_end - grid->row_begin - inner;
}
static inline size_t stokes_grid_nth(const struct stokes_grid *grid, int part, size_t n) {
  if (!RANKS) return n;
  if (part == 0) return grid->inner_begin + n;
  const size_t low = grid->inner_begin - grid->row_begin;
  return n < low ? grid->row_begin + n : grid->inner_end + n - low;
}
/* Rows of this rank. */
static inline size_t stokes_grid_begin(const struct stokes_grid *grid) {
  return RANKS ? grid->row_begin : 0;
}
static inline size_t stokes_grid_end(const struct stokes_grid *grid) {
  return grid->row_end;
}
/* Planes solved by all ranks together: half of those of a mirrored lattice. */
static inline size_t stokes_grid_planes(const struct stokes_grid *grid) {
  return grid->mirrored ? grid->row_end / grid->size[1] : grid->size[2];
}
static inline bool stokes_grid_is_halved(const struct stokes_grid *grid) {
  return grid->columns < grid->size[1];
}
/* Whether a row before `row_end` is not solved, but is the image of another in y. */
static inline bool stokes_grid_is_y_image(const struct stokes_grid *grid, size_t row) {
  return stokes_grid_is_halved(grid) && row % grid->size[1] >= grid->columns;
}
/* Number of times that a row counts in sums over the lattice. */
static inline double stokes_grid_weight(const struct stokes_grid *grid, size_t row) {
  const double copies = stokes_grid_is_halved(grid) ? 2.0 : 1.0;
  if (!grid->mirrored) return copies;
  return grid->size[2] % 2 == 1 && row + grid->size[1] >= grid->row_end ? copies : 2.0 * copies;
}
/* Whether velocities along an axis cancel in sums over the lattice, being opposite in the two
 * halves. */
static inline bool stokes_grid_cancels(const struct stokes_grid *grid, int axis) {
  return (grid->mirrored && grid->parity[axis] < 0.0f) ||
         (axis == 1 && stokes_grid_is_halved(grid));
}
/* The row of which `row` is the image in z. */
static inline size_t stokes_grid_image(const struct stokes_grid *grid, size_t row) {
  const size_t ny = grid->size[1];
  return (grid->size[2] - 1 - row / ny) * ny + row % ny;
}
/* Sets a row of a field, floats or (`wide`) doubles, to `sign` times the row `from`. */
static inline void stokes_grid_copy_row(const struct stokes_grid *grid, float sign, size_t from,
                                        size_t row, void *field, bool wide) {
  const size_t in = from * grid->stride, out = row * grid->stride;
  float *narrow = field;
  double *doubles = field;
  if (wide)
    for (size_t i = 0; i < grid->stride; i++) doubles[out + i] = (double)sign * doubles[in + i];
  else
    for (size_t i = 0; i < grid->stride; i++) narrow[out + i] = sign * narrow[in + i];
}
/* Within a parallel region: fills the ghost rows of a field of `stride` floats or doubles a row.
 * Images are complete on return; the exchange with other ranks is started, and completed by
 * stokes_grid_await before part 1. component: 0 to 2 velocity, 3 pressure, -1 an even field. */
static inline void stokes_grid_post(const struct stokes_grid *grid, int component, void *field,
                                    size_t bytes) {
  const bool wide = bytes == grid->stride * sizeof(double);
  if (stokes_grid_is_halved(grid)) {
    const size_t ny = grid->size[1], images = (size_t)grid->images;
    const size_t count = 2 * images * (grid->row_end / ny);
#pragma omp for schedule(static)
    for (size_t n = 0; n < count; n++) {
      const size_t beyond = n % (2 * images), plane = n / (2 * images) * ny;
      const size_t j = beyond < images ? grid->columns + beyond : ny - 1 - (beyond - images);
      stokes_grid_copy_row(grid, component == 1 ? -1.0f : 1.0f, plane + ny - 1 - j, plane + j,
                           field, wide);
    }
  }
  if (grid->mirrored) {
    const float sign = component < 0 ? 1.0f : grid->parity[component];
    const size_t ny = grid->size[1], first = grid->row_end, count = (size_t)grid->images * ny;
#pragma omp for schedule(static)
    for (size_t n = 0; n < 2 * count; n++) {
      const size_t row = n < count ? first + n : grid->rows - 1 - (n - count);
      stokes_grid_copy_row(grid, sign, stokes_grid_image(grid, row), row, field, wide);
    }
  }
  if (!RANKS || grid->reach == 0) return;
#pragma omp master
  slabs_post(&grid->slabs, 0, field, bytes * grid->size[1], (size_t)grid->reach);
}
static inline void stokes_grid_await(const struct stokes_grid *grid, int part) {
  if (!RANKS || part == 0 || grid->reach == 0) return;
#pragma omp master
  ranks_wait();
#pragma omp barrier
}

static inline int stokes_grid_is_active(const struct stokes_grid *grid, size_t row, size_t i) {
  return grid->mask[row * grid->chunks + i / STOKES_LANES] >> (i % STOKES_LANES) & 1;
}

/* The row at an offset, with periodic wrapping. */
static inline size_t stokes_grid_row(const struct stokes_grid *grid, size_t j, size_t k, int dj,
                                     int dk) {
  const long ny = (long)grid->size[1], nz = (long)grid->size[2];
  long y = (long)j + dj, z = (long)k + dk;
  while (y < 0) y += ny;
  while (y >= ny) y -= ny;
  while (z < 0) z += nz;
  while (z >= nz) z -= nz;
  return (size_t)(z * ny + y);
}

#endif
