#include "sphsolve/darcy/rows.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/darcy/constants.h"

enum status rows_allocate(size_t count, size_t entries, struct rows *r) {
  enum status status = STATUS_OK;
  *r = (struct rows){.count = count};
  TRY(memory_allocate(&r->start, count + 1, sizeof *r->start, "the matrix"));
  TRY(memory_allocate(&r->diagonal, count, sizeof *r->diagonal, "the matrix"));
  TRY(memory_allocate(&r->column, entries, sizeof *r->column, "the matrix"));
  TRY(memory_allocate(&r->value, entries, sizeof *r->value, "the matrix"));
  TRY(memory_allocate(&r->factor, entries, sizeof *r->factor, "the matrix"));
  for (int v = 0; v < 7; v++)
    TRY(memory_allocate(&r->vector[v], count, sizeof(double), "the linear solver"));
cleanup:
  return status;
}

void rows_free(struct rows *r) {
  memory_free(&r->start);
  memory_free(&r->diagonal);
  memory_free(&r->column);
  memory_free(&r->value);
  memory_free(&r->factor);
  for (int v = 0; v < 7; v++) memory_free(&r->vector[v]);
}

size_t rows_entry(const struct rows *r, size_t row, size_t column) {
  size_t k = r->start[row];
  while (k < r->start[row + 1] && r->column[k] != column) k++;
  return k;
}

static bool factorise(struct rows *r, double share) {
  memcpy(r->factor, r->value, r->start[r->count] * sizeof *r->factor);
  for (size_t row = 0; row < r->count; row++) {
    const size_t first = r->diagonal[row] + 1, end = r->start[row + 1];
    const double pivot = r->factor[first - 1];
    if (!(fabs(pivot) > 0)) return false;
    for (size_t k = first; k < end; k++) {
      const size_t below = r->column[k];
      const double l = r->factor[rows_entry(r, below, row)] /= pivot;
      for (size_t u = first; u < end; u++) {
        const size_t at = rows_entry(r, below, r->column[u]);
        if (at < r->start[below + 1])
          r->factor[at] -= l * r->factor[u];
        else
          r->factor[r->diagonal[r->column[u]]] -= share * l * r->factor[u];
      }
    }
  }
  return true;
}

/* Solves L U y = x. */
static void precondition(const struct rows *r, const double *x, double *y) {
  for (size_t i = 0; i < r->count; i++) {
    double sum = x[i];
    for (size_t k = r->start[i]; k < r->diagonal[i]; k++) sum -= r->factor[k] * y[r->column[k]];
    y[i] = sum;
  }
  for (size_t i = r->count; i-- > 0;) {
    double sum = y[i];
    for (size_t k = r->diagonal[i] + 1; k < r->start[i + 1]; k++)
      sum -= r->factor[k] * y[r->column[k]];
    y[i] = sum / r->factor[r->diagonal[i]];
  }
}

static void apply(const struct rows *r, const double *x, double *y) {
#pragma omp parallel for schedule(static) if (r->count > 10000)
  for (size_t i = 0; i < r->count; i++) {
    double sum = 0;
    for (size_t k = r->start[i]; k < r->start[i + 1]; k++) sum += r->value[k] * x[r->column[k]];
    y[i] = sum;
  }
}

static double dot(size_t n, const double *x, const double *y) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) sum += x[i] * y[i];
  return sum;
}

/* Right-preconditioned, so that all scalar products are of residuals, which are water contents;
 * heads of dry soil may be 1e40 times larger than those of wet soil. */
bool rows_solve(struct rows *r, double share, const double *b, double tolerance, double *x,
                int64_t *iterations) {
  const size_t n = r->count;
  double *residual = r->vector[0], *shadow = r->vector[1], *p = r->vector[2], *v = r->vector[3],
         *t = r->vector[4], *y = r->vector[5], *z = r->vector[6];
  const double wanted = tolerance * sqrt(dot(n, b, b));
  double rho = 1, alpha = 1, omega = 1;
  if (!factorise(r, share)) return false;
  memset(x, 0, n * sizeof *x);
  memset(p, 0, n * sizeof *p);
  memset(v, 0, n * sizeof *v);
  memcpy(residual, b, n * sizeof *residual);
  memcpy(shadow, b, n * sizeof *shadow);
  for (int round = 0; round < LINEAR_ITERATIONS_MAX; round++) {
    if (sqrt(dot(n, residual, residual)) <= wanted) return true;
    const double next = dot(n, shadow, residual), beta = next / rho * alpha / omega;
    rho = next;
    for (size_t i = 0; i < n; i++) p[i] = residual[i] + beta * (p[i] - omega * v[i]);
    precondition(r, p, y);
    apply(r, y, v);
    alpha = rho / dot(n, shadow, v);
    for (size_t i = 0; i < n; i++) residual[i] -= alpha * v[i];
    precondition(r, residual, z);
    apply(r, z, t);
    const double square = dot(n, t, t);
    omega = square > 0 ? dot(n, t, residual) / square : 0;
    for (size_t i = 0; i < n; i++) {
      x[i] += alpha * y[i] + omega * z[i];
      residual[i] -= omega * t[i];
    }
    ++*iterations;
    if (!isfinite(alpha) || !isfinite(omega)) return false;
    if (omega == 0) return sqrt(dot(n, residual, residual)) <= wanted;
  }
  return false;
}
