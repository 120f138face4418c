#include "sphsolve/stokes/solver/darcy.h"
#include "sphsolve/stokes/constants.h"

#include <omp.h>
#include <string.h>

#include "common/variants.h"
#include "sphsolve/stokes/solver/cuts.h"

#define KAPPA 0 /* slots of the fields */
#define PRESSURE 1

enum { OWN, Y_LOW, Y_HIGH, Z_LOW, Z_HIGH, ROWS };

static inline float mean(float t, float here, float there) {
  return there > 0.0f ? t * (here + there) : 0.0f;
}

/* Harmonic mean (resistances in series), for kappa that jumps at the surface of soil. */
static inline float series(float t, float here, float there) {
  return there > 0.0f && here > 0.0f ? 4.0f * t * here * there / (here + there) : 0.0f;
}

/* T x and the diagonal of T on one row. t: 1 / (2 dx^2) along x, y, z; 0 where there is no such
 * axis. */
static inline __attribute__((always_inline)) void
row_of(size_t nx, const float *const kappa[ROWS], const float *const x[ROWS], const float t[3],
       float (*coupling)(float, float, float), float *restrict sum, float *restrict diagonal) {
  const float *k = kappa[OWN], *u = x[OWN];
  for (size_t i = 0; i < nx; i++) sum[i] = diagonal[i] = 0.0f;
  for (int n = Y_LOW; n < ROWS; n++) {
    const float *kn = kappa[n], *un = x[n], tn = t[n < Z_LOW ? 1 : 2];
    for (size_t i = 0; i < nx; i++) {
      const float c = coupling(tn, k[i], kn[i]);
      sum[i] += c * (u[i] - un[i]);
      diagonal[i] += c;
    }
  }
  for (size_t i = 1; i < nx; i++) {
    const float c = coupling(t[0], k[i], k[i - 1]);
    sum[i] += c * (u[i] - u[i - 1]);
    diagonal[i] += c;
  }
  for (size_t i = 0; i + 1 < nx; i++) {
    const float c = coupling(t[0], k[i], k[i + 1]);
    sum[i] += c * (u[i] - u[i + 1]);
    diagonal[i] += c;
  }
  const float low = coupling(t[0], k[0], k[nx - 1]), high = coupling(t[0], k[nx - 1], k[0]);
  sum[0] += low * (u[0] - u[nx - 1]);
  diagonal[0] += low;
  sum[nx - 1] += high * (u[nx - 1] - u[0]);
  diagonal[nx - 1] += high;
}

TARGETS static void mean_row(size_t nx, const float *const kappa[ROWS], const float *const x[ROWS],
                             const float t[3], float *restrict sum, float *restrict diagonal) {
  row_of(nx, kappa, x, t, mean, sum, diagonal);
}
TARGETS static void series_row(size_t nx, const float *const kappa[ROWS],
                               const float *const x[ROWS], const float t[3], float *restrict sum,
                               float *restrict diagonal) {
  row_of(nx, kappa, x, t, series, sum, diagonal);
}

/* Takes the faces of a row that thin walls cut out of T p and its diagonal. */
static void subtract_cuts(const struct stokes_operator *op, size_t row, const float t[3],
                          float *sum, float *diagonal) {
  const size_t nx = op->grid->size[0], stride = op->grid->stride;
  const float *kappa = stokes_operator_field(op, KAPPA), *p = stokes_operator_field(op, PRESSURE);
  if (op->cuts == NULL) return;
  for (size_t c = op->cut_start[row]; c < op->cut_start[row + 1]; c++) {
    const size_t there = op->cuts[c].other;
    const int *step = op->stencil->offsets[op->cuts[c].offset].step;
    if (step[0] * step[0] + step[1] * step[1] + step[2] * step[2] != 1) continue;
    const size_t i = (size_t)((long)(there % stride + nx) - step[0]) % nx;
    const size_t here = row * stride + i;
    const float coupling = (op->soil ? series : mean)(t[step[0]   ? 0
                                                        : step[1] ? 1
                                                                  : 2],
                                                      kappa[here], kappa[there]);
    sum[i] -= coupling * (p[here] - p[there]);
    diagonal[i] -= coupling;
  }
}

/* Computes packed T p (of the field) and the diagonal on a row, in the buffers of the thread. */
static void find_row(const struct stokes_operator *op, size_t row, const float **sum,
                     const float **diagonal) {
  const struct stokes_grid *grid = op->grid;
  const size_t j = row % grid->size[1], k = row / grid->size[1], stride = grid->stride;
  const float *kappa = stokes_operator_field(op, KAPPA), *p = stokes_operator_field(op, PRESSURE);
  const float *k_rows[ROWS], *p_rows[ROWS];
  static const int step[ROWS][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}};
  float t[3] = {0.0f};
  for (int c = 0; c < op->stencil->axis_count; c++) {
    const int a = op->stencil->axes[c];
    t[a] = (float)(0.5 / (op->stencil->spacing[a] * op->stencil->spacing[a]));
  }
  for (int n = 0; n < ROWS; n++) {
    const size_t at = stride * stokes_grid_row(grid, j, k, step[n][0], step[n][1]);
    k_rows[n] = kappa + at;
    p_rows[n] = p + at;
  }
  float *full = op->scratch + (size_t)omp_get_thread_num() * op->scratch_size;
  float *packed = full + 2 * stride;
  const uint16_t *mask = grid->mask + row * grid->chunks;
  (op->soil ? series_row : mean_row)(grid->size[0], k_rows, p_rows, t, full, full + stride);
  subtract_cuts(op, row, t, full, full + stride);
  op->rows->pack(mask, grid->chunks, full, packed);
  op->rows->pack(mask, grid->chunks, full + stride, packed + stride);
  *sum = packed;
  *diagonal = packed + stride;
}

void stokes_darcy_begin(struct stokes_operator *op, const float *kappa) {
#pragma omp parallel num_threads(op->threads)
  {
    stokes_operator_unpack(op, kappa, KAPPA, -1);
    if (RANKS) stokes_grid_await(op->grid, 1);
  }
}

enum task { START, RESIDUAL, SMOOTH };

static void sweep(struct stokes_operator *op, enum task task, const float *r, const float *p,
                  float *out) {
  const struct stokes_grid *grid = op->grid;
#pragma omp parallel num_threads(op->threads)
  {
    if (task != START) stokes_operator_unpack(op, p, PRESSURE, 3);
    for (int part = 0; part < STOKES_PARTS; part++) {
      if (task != START) stokes_grid_await(grid, part);
#pragma omp for schedule(static)
      for (size_t n = 0; n < stokes_grid_part(grid, part); n++) {
        const size_t row = stokes_grid_nth(grid, part, n);
        const size_t start = grid->row_start[row], count = grid->row_start[row + 1] - start;
        const float *sum, *diagonal;
        if (count == 0) continue;
        find_row(op, row, &sum, &diagonal);
        for (size_t i = 0; i < count; i++) {
          const float left = task == START ? r[start + i] : r[start + i] - sum[i];
          const float step = diagonal[i] > 0.0f ? (float)DAMPING * left / diagonal[i] : 0.0f;
          out[start + i] = task == RESIDUAL ? left : task == START ? step : p[start + i] + step;
        }
      }
    }
  }
}

void stokes_darcy_start(struct stokes_operator *op, const float *r, float *p) {
  sweep(op, START, r, NULL, p);
}

void stokes_darcy_residual(struct stokes_operator *op, const float *r, const float *p, float *out) {
  sweep(op, RESIDUAL, r, p, out);
}

void stokes_darcy_smooth(struct stokes_operator *op, const float *r, float *p) {
  sweep(op, SMOOTH, r, p, p);
}
