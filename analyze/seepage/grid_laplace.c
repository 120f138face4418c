#include "analyze/seepage/grid_laplace.h"

#include <string.h>

#include "common/memory.h"

enum status grid_laplace_create(size_t nx, size_t nz, struct grid_laplace *grid) {
  enum status status = STATUS_OK;
  size_t n;
  *grid = (struct grid_laplace){.nx = nx, .nz = nz};
  if (!size_multiply(nx, nz, &n)) TRY_FAIL(STATUS_RUN, "a grid of %zu x %zu: too large", nx, nz);
  TRY(memory_allocate(&grid->along, n, sizeof *grid->along, "a grid"));
  TRY(memory_allocate(&grid->upward, n, sizeof *grid->upward, "a grid"));
  TRY(memory_allocate(&grid->held, n, sizeof *grid->held, "a grid"));
  TRY(memory_allocate(&grid->source, n, sizeof *grid->source, "a grid"));
cleanup:
  if (status != STATUS_OK) grid_laplace_free(grid);
  return status;
}

void grid_laplace_free(struct grid_laplace *grid) {
  memory_free(&grid->along);
  memory_free(&grid->upward);
  memory_free(&grid->held);
  memory_free(&grid->source);
}

static void apply(const struct grid_laplace *g, const double *x, double *y) {
  const size_t n = g->nx * g->nz;
  for (size_t c = 0; c < n; c++) y[c] = g->held[c] * x[c];
  for (size_t c = 0; c < n; c++) {
    if (c % g->nx + 1 < g->nx) {
      const double flux = g->along[c] * (x[c + 1] - x[c]);
      y[c + 1] += flux, y[c] -= flux;
    }
    if (c + g->nx < n) {
      const double flux = g->upward[c] * (x[c + g->nx] - x[c]);
      y[c + g->nx] += flux, y[c] -= flux;
    }
  }
}

static void add_diagonal(const struct grid_laplace *g, double *diagonal) {
  const size_t n = g->nx * g->nz;
  memcpy(diagonal, g->held, n * sizeof *diagonal);
  for (size_t c = 0; c < n; c++) {
    if (c % g->nx + 1 < g->nx) diagonal[c] += g->along[c], diagonal[c + 1] += g->along[c];
    if (c + g->nx < n) diagonal[c] += g->upward[c], diagonal[c + g->nx] += g->upward[c];
  }
}

static double dot(const double *a, const double *b, size_t n) {
  double sum = 0;
  for (size_t c = 0; c < n; c++) sum += a[c] * b[c];
  return sum;
}

enum status grid_laplace_solve(const struct grid_laplace *g, double goal, double *x) {
  enum status status = STATUS_OK;
  const size_t n = g->nx * g->nz;
  double *r = NULL, *p = NULL, *q = NULL, *inverse = NULL, first = 0, rz = 0;
  TRY(memory_allocate(&r, n, sizeof *r, "a grid"));
  TRY(memory_allocate(&p, n, sizeof *p, "a grid"));
  TRY(memory_allocate(&q, n, sizeof *q, "a grid"));
  TRY(memory_allocate(&inverse, n, sizeof *inverse, "a grid"));
  add_diagonal(g, inverse);
  apply(g, x, q);
  for (size_t c = 0; c < n; c++) {
    inverse[c] = inverse[c] > 0 ? 1 / inverse[c] : 0;
    first += g->source[c] * inverse[c] * g->source[c];
    r[c] = g->source[c] - q[c];
    p[c] = inverse[c] * r[c];
  }
  rz = dot(r, p, n);
  for (size_t step = 0; rz > goal * goal * first && step < 20 * (g->nx + g->nz); step++) {
    apply(g, p, q);
    const double alpha = rz / dot(p, q, n);
    double next = 0;
    for (size_t c = 0; c < n; c++) {
      x[c] += alpha * p[c], r[c] -= alpha * q[c];
      next += r[c] * inverse[c] * r[c];
    }
    for (size_t c = 0; c < n; c++) p[c] = inverse[c] * r[c] + next / rz * p[c];
    rz = next;
  }
cleanup:
  memory_free(&r);
  memory_free(&p);
  memory_free(&q);
  memory_free(&inverse);
  return status;
}
