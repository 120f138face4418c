#include "sphsolve/stokes/solver/start.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"

void stokes_solver_strip(struct stokes_solver *s) {
  stokes_operator_free(&s->operator);
  stokes_preconditioner_free(&s->preconditioner);
  stokes_krylov_free(&s->krylov);
  s->residual = NULL;
}

/* One row of the coarse lattice: velocities, pressure and a mask of active sites; zero at all
 * others. */
static void unpack_row(const struct stokes_solver *s, size_t row, float *out, size_t pitch) {
  const struct stokes_grid *grid = &s->grid;
  const bool image = row >= grid->row_end;
  const size_t from = image ? stokes_grid_image(grid, row) : row;
  const int components = s->stencil.axis_count + 1;
  size_t n = grid->row_start[from];
  memset(out, 0, (size_t)(components + 1) * pitch * sizeof *out);
  for (size_t i = 0; i < grid->size[0]; i++) {
    if (!stokes_grid_is_active(grid, from, i)) continue;
    for (int c = 0; c < components; c++) {
      const int axis = c + 1 < components ? s->stencil.axes[c] : 3;
      out[(size_t)c * pitch + i] =
          (image ? grid->parity[axis] : 1.0f) * (float)s->x[(size_t)c * grid->active + n];
    }
    out[(size_t)components * pitch + i] = 1.0f;
    n++;
  }
}

/* The two sites around a position along an axis, and the weight of the second. */
static void find_pair(double at, size_t size, size_t index[2], float *share) {
  const double whole = floor(at);
  *share = (float)(at - whole);
  for (int i = 0; i < 2; i++) {
    long n = ((long)whole + i) % (long)size;
    index[i] = (size_t)(n < 0 ? n + (long)size : n);
  }
}

enum status stokes_solver_start(struct stokes_solver *fine, const struct stokes_solver *coarse) {
  enum status status = STATUS_OK;
  const struct stokes_grid *grid = &fine->grid, *from = &coarse->grid;
  const int components = fine->stencil.axis_count + 1;
  const size_t pitch = from->size[0], block = (size_t)(components + 1) * pitch;
  const int threads = omp_get_max_threads();
  float *rows = NULL;
  double scale[4], ratio[3];
  if (from->active == 0 || RANKS) return STATUS_OK;
  TRY(memory_allocate(&rows, 4 * block * (size_t)threads, sizeof *rows, "the first velocity"));
  for (int a = 0; a < 3; a++)
    ratio[a] = fine->stencil.axis_count == 2 && a == 1
                   ? 1.0
                   : fine->stencil.spacing[a] * fine->stencil.unit /
                         (coarse->stencil.spacing[a] * coarse->stencil.unit);
  for (int c = 0; c + 1 < components; c++) scale[c] = coarse->velocity_unit / fine->velocity_unit;
  scale[components - 1] =
      coarse->acceleration * coarse->stencil.unit / (fine->acceleration * fine->stencil.unit);
#pragma omp parallel for schedule(static)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    if (grid->row_start[row] == grid->row_start[row + 1] || interrupt_alone()) continue;
    float *buffer = rows + 4 * block * (size_t)omp_get_thread_num(), share[3];
    size_t j[2], k[2], i[2], n = grid->row_start[row];
    const double y = ((double)(row % grid->size[1]) + 0.5) * ratio[1] - 0.5;
    // NOLINTNEXTLINE: whole rows
    const double z = ((double)(row / grid->size[1]) + 0.5) * ratio[2] - 0.5;
    find_pair(y, from->size[1], j, &share[1]);
    find_pair(z, from->size[2], k, &share[2]);
    for (int r = 0; r < 4; r++)
      unpack_row(coarse, k[r / 2] * from->size[1] + j[r % 2], buffer + (size_t)r * block, pitch);
    for (size_t x = 0; x < grid->size[0]; x++) {
      if (!stokes_grid_is_active(grid, row, x)) continue;
      float sum[5] = {0.0f};
      find_pair(((double)x + 0.5) * ratio[0] - 0.5, from->size[0], i, &share[0]);
      for (int corner = 0; corner < 8; corner++) {
        const int r = corner >> 1, sx = corner & 1, sy = r & 1, sz = r >> 1;
        const float w = (sx ? share[0] : 1.0f - share[0]) * (sy ? share[1] : 1.0f - share[1]) *
                        (sz ? share[2] : 1.0f - share[2]);
        const float *values = buffer + (size_t)r * block + i[sx];
        for (int c = 0; c <= components; c++) sum[c] += w * values[(size_t)c * pitch];
      }
      /* Velocity falls to zero in the walls; pressure is averaged over active sites only. */
      for (int c = 0; c + 1 < components; c++)
        fine->x[(size_t)c * grid->active + n] = scale[c] * (double)sum[c];
      fine->x[(size_t)(components - 1) * grid->active + n] =
          sum[components] > 0.0f
              ? scale[components - 1] * (double)(sum[components - 1] / sum[components])
              : 0.0;
      n++;
    }
  }
  TRY(interrupt_look());
  stokes_solver_restart(fine);
cleanup:
  memory_free(&rows);
  return status;
}
