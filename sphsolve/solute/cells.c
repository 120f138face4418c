#include "sphsolve/solute/cells.h"

#include <string.h>

#include "common/memory.h"

static enum status allocate(struct solute_cells *c, bool flows) {
  enum status status = STATUS_OK;
  c->stride[0] = 1;
  c->stride[1] = (size_t)c->n[0] + 2;
  c->stride[2] = c->stride[1] * ((size_t)c->n[1] + 2);
  c->size = c->stride[2] * ((size_t)c->n[2] + 2);
  for (int a = 0; a < 3; a++) {
    TRY(memory_allocate(&c->width[a], (size_t)c->n[a], sizeof(double), "widths of cells"));
    TRY(memory_allocate(&c->conductance[a], c->size, sizeof(float), "conductances of faces"));
    if (flows) TRY(memory_allocate(&c->flux[a], c->size, sizeof(float), "fluxes through faces"));
  }
  TRY(memory_allocate(&c->volume, c->size, sizeof(float), "volumes of cells"));
cleanup:
  return status;
}

void solute_cells_free(struct solute_cells *c) {
  for (int a = 0; a < 3; a++) {
    MEMORY_FREE(&c->width[a], &c->conductance[a], &c->flux[a]);
  }
  memory_free(&c->volume);
}

// NOLINTBEGIN(bugprone-macro-parentheses): a function's name and a type
#define WRAP(name, type)                                                                           \
  void name(const struct solute_cells *c, type *x) {                                               \
    const size_t s1 = c->stride[1], s2 = c->stride[2];                                             \
    const size_t nx = (size_t)c->n[0], ny = (size_t)c->n[1], nz = (size_t)c->n[2];                 \
    _Pragma("omp parallel for schedule(static)") for (size_t k = 1; k <= nz; k++) {                \
      type *plane = x + k * s2;                                                                    \
      for (size_t j = 1; j <= ny; j++) {                                                           \
        plane[j * s1] = plane[j * s1 + nx];                                                        \
        plane[j * s1 + nx + 1] = plane[j * s1 + 1];                                                \
      }                                                                                            \
      memcpy(plane, plane + ny * s1, s1 * sizeof *x);                                              \
      memcpy(plane + (ny + 1) * s1, plane + s1, s1 * sizeof *x);                                   \
    }                                                                                              \
    memcpy(x, x + nz * s2, s2 * sizeof *x);                                                        \
    memcpy(x + (nz + 1) * s2, x + s2, s2 * sizeof *x);                                             \
  }
// NOLINTEND(bugprone-macro-parentheses)
WRAP(solute_cells_wrap, float)
WRAP(solute_cells_wrap_exact, double)

/* Wraps the coefficients of the faces; those at the high side of the last cells are needed, too. */
static void wrap_faces(const struct solute_cells *c) {
  for (int a = 0; a < 3; a++) {
    solute_cells_wrap(c, c->conductance[a]);
    if (c->flux[a] != NULL) solute_cells_wrap(c, c->flux[a]);
  }
}

enum status solute_cells_of_flow(const struct solute_flow *f, const int axis[3],
                                 struct solute_cells *c) {
  enum status status = STATUS_OK;
  const double unit = f->spacing[0];
  const size_t step[3] = {1, (size_t)f->n[0], (size_t)f->n[0] * (size_t)f->n[1]};
  *c = (struct solute_cells){.n = {f->n[axis[0]], f->n[axis[1]], f->n[axis[2]]}};
  TRY(allocate(c, f->speed > 0));
  double width[3], volume = 1;
  for (int a = 0; a < 3; a++) {
    width[a] = f->spacing[axis[a]] / unit;
    volume *= width[a];
    for (int i = 0; i < c->n[a]; i++) c->width[a][i] = width[a];
  }
#pragma omp parallel for schedule(static)
  for (int k = 0; k < c->n[2]; k++)
    for (int j = 0; j < c->n[1]; j++)
      for (int i = 0; i < c->n[0]; i++) {
        const size_t at = solute_cells_at(c, i, j, k);
        const size_t from =
            (size_t)i * step[axis[0]] + (size_t)j * step[axis[1]] + (size_t)k * step[axis[2]];
        c->volume[at] = (float)(volume * (double)f->volume[from]);
        for (int a = 0; a < 3; a++) {
          /* no flux between a cell and itself */
          if (c->n[a] == 1) continue;
          const double area = volume / width[a];
          c->conductance[a][at] = (float)(area / width[a] * (double)f->aperture[axis[a]][from]);
          if (c->flux[a] != NULL)
            c->flux[a][at] = (float)(area * (double)f->velocity[axis[a]][from] / f->speed);
        }
      }
  wrap_faces(c);
cleanup:
  if (status != STATUS_OK) solute_cells_free(c);
  return status;
}

enum status solute_cells_coarsen(const struct solute_cells *f, struct solute_cells *c) {
  enum status status = STATUS_OK;
  *c = (struct solute_cells){.n = {(f->n[0] + 1) / 2, (f->n[1] + 1) / 2, (f->n[2] + 1) / 2}};
  TRY(allocate(c, f->flux[0] != NULL));
  for (int a = 0; a < 3; a++)
    for (int i = 0; i < f->n[a]; i++) c->width[a][i / 2] += f->width[a][i];
#pragma omp parallel for schedule(static)
  for (int k = 0; k < c->n[2]; k++)
    for (int j = 0; j < c->n[1]; j++)
      for (int i = 0; i < c->n[0]; i++) {
        const size_t at = solute_cells_at(c, i, j, k);
        const int x[3] = {i, j, k};
        double volume = 0, area[3] = {0}, flux[3] = {0};
        for (int o = 0; o < 8; o++) {
          const int y[3] = {2 * i + (o & 1), 2 * j + (o >> 1 & 1), 2 * k + (o >> 2)};
          if (y[0] >= f->n[0] || y[1] >= f->n[1] || y[2] >= f->n[2]) continue;
          const size_t from = solute_cells_at(f, y[0], y[1], y[2]);
          volume += (double)f->volume[from];
          for (int a = 0; a < 3; a++) {
            if (o >> a & 1) continue;
            area[a] += (double)f->conductance[a][from] * solute_cells_apart(f, a, y[a]);
            if (f->flux[a] != NULL) flux[a] += (double)f->flux[a][from];
          }
        }
        c->volume[at] = (float)volume;
        for (int a = 0; a < 3; a++) {
          if (c->n[a] == 1) continue;
          c->conductance[a][at] = (float)(area[a] / solute_cells_apart(c, a, x[a]));
          if (c->flux[a] != NULL) c->flux[a][at] = (float)flux[a];
        }
      }
  wrap_faces(c);
cleanup:
  if (status != STATUS_OK) solute_cells_free(c);
  return status;
}

/* Adds to `y` A x of the row of cells beginning at `at`: the flux out through the six faces. The
 * terms F b_P of all faces add up to 0, as the fluxes do, and are omitted. */
#define ROW(type)                                                                                  \
  const float half = (float)(0.5 * s);                                                             \
  for (int a = 0; a < 3; a++) {                                                                    \
    const float *g = c->conductance[a] + at,                                                       \
                *u = c->flux[a] != NULL && s > 0 ? c->flux[a] + at : NULL;                         \
    const type *b = x + at;                                                                        \
    const size_t d = c->stride[a];                                                                 \
    if (u != NULL)                                                                                 \
      for (size_t i = 0; i < nx; i++)                                                              \
        y[i] += (type)(half * u[i + d] - g[i + d]) * (b[i + d] - b[i]) +                           \
                (type)(half * u[i] + g[i]) * (b[i] - (b + i)[-(ptrdiff_t)d]);                      \
    else                                                                                           \
      for (size_t i = 0; i < nx; i++)                                                              \
        y[i] += (type)g[i] * (b[i] - (b + i)[-(ptrdiff_t)d]) - (type)g[i + d] * (b[i + d] - b[i]); \
  }

static inline void row_float(const struct solute_cells *c, double s, size_t at, size_t nx,
                             const float *x, float *y) {
  ROW(float)
}

static inline void row_double(const struct solute_cells *c, double s, size_t at, size_t nx,
                              const double *x, double *y) {
  ROW(double)
}

void solute_cells_apply(const struct solute_cells *c, double s, const float *x, float *y) {
  const size_t nx = (size_t)c->n[0];
#pragma omp parallel for schedule(static)
  for (int k = 0; k < c->n[2]; k++)
    for (int j = 0; j < c->n[1]; j++) {
      const size_t at = solute_cells_at(c, 0, j, k);
      memset(y + at, 0, nx * sizeof *y);
      row_float(c, s, at, nx, x, y + at);
    }
}

void solute_cells_residual(const struct solute_cells *c, double s, const double *source,
                           const double *x, float *y) {
  const size_t nx = (size_t)c->n[0];
#pragma omp parallel for schedule(static)
  for (int k = 0; k < c->n[2]; k++) {
    double sum[4096];
    for (int j = 0; j < c->n[1]; j++)
      for (size_t i0 = 0; i0 < nx; i0 += 4096) {
        const size_t at = solute_cells_at(c, (int)i0, j, k), n = nx - i0 < 4096 ? nx - i0 : 4096;
        memset(sum, 0, n * sizeof *sum);
        row_double(c, s, at, n, x, sum);
        for (size_t i = 0; i < n; i++) y[at + i] = (float)(source[at + i] - sum[i]);
      }
  }
}

double solute_cells_mean(const struct solute_cells *c, const double *x) {
  double sum = 0, volume = 0;
  for (int k = 0; k < c->n[2]; k++)
    for (int j = 0; j < c->n[1]; j++)
      for (int i = 0; i < c->n[0]; i++) {
        const size_t at = solute_cells_at(c, i, j, k);
        sum += x[at] * (double)c->volume[at];
        volume += (double)c->volume[at];
      }
  return volume > 0 ? sum / volume : 0;
}
