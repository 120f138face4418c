/* Which sites method stokes solves on, and how they are stored: vectors are packed (active sites
 * only, x fastest); stencils read full rows, unpacked a field at a time. */
#ifndef TOSUI_SPHSOLVE_METHODS_STOKES_GRID_H
#define TOSUI_SPHSOLVE_METHODS_STOKES_GRID_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/lattice.h"
#include "sphsolve/methods/stokes_rows.h"

struct stokes_grid {
  size_t size[3];
  size_t rows;           /* size[1] * size[2]; row (j, k) has number k * size[1] + j */
  size_t chunks, stride; /* of a row: STOKES_LANES floats a chunk, stride = STOKES_LANES * chunks */
  size_t active;         /* sites solved */
  uint16_t *mask;        /* [rows][chunks]: bit b of chunk c is site c * STOKES_LANES + b */
  size_t *row_start;     /* [rows + 1]: first packed index of a row */
};

/* Fluid sites through which fluid can flow: those of face-connected pores that lead around the
 * periodic box in a direction along which `driving` does work. In all others a body force is
 * balanced by pressure. `keep_all`: walls move, every pore may flow. */
enum status stokes_grid_build(const struct lattice *lattice, const double driving[3], int keep_all,
                              struct stokes_grid *grid);
void stokes_grid_free(struct stokes_grid *grid);

static inline int stokes_grid_is_active(const struct stokes_grid *grid, size_t row, size_t i) {
  return grid->mask[row * grid->chunks + i / STOKES_LANES] >> (i % STOKES_LANES) & 1;
}

/* Row at an offset, around the periodic box as often as need be. */
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
