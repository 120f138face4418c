#include "sphsolve/stokes/solver/krylov.h"

#include <math.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/stokes/solver/sums.h"

#define BASIS_MAX 64

enum status stokes_krylov_build(size_t length, int basis_max, struct stokes_krylov *k) {
  enum status status = STATUS_OK;
  k->length = length;
  k->basis_max = basis_max < BASIS_MAX ? basis_max : BASIS_MAX;
  k->alone = false;
  k->basis = NULL, k->work = NULL, k->partial = NULL, k->columns = NULL;
  TRY(memory_allocate(&k->basis, (size_t)(k->basis_max + 1) * length, sizeof *k->basis,
                      "Krylov basis"));
  TRY(memory_allocate(&k->work, length, sizeof *k->work, "Krylov vector"));
  TRY(memory_allocate(&k->partial, stokes_sum_blocks(length), sizeof *k->partial, "partial sums"));
  TRY(memory_allocate(&k->columns, (BASIS_MAX + 1) * BASIS_MAX, sizeof *k->columns,
                      "Krylov basis"));
  return STATUS_OK;
cleanup:
  stokes_krylov_free(k);
  return status;
}

void stokes_krylov_free(struct stokes_krylov *k) {
  MEMORY_FREE(&k->basis, &k->work, &k->partial, &k->columns);
}

static double dot(struct stokes_krylov *k, const float *x, const float *y) {
  const double own = stokes_sum_dot(k->length, x, y, k->partial);
  return k->alone ? own : ranks_sum(own);
}

double stokes_krylov_norm(struct stokes_krylov *k, const float *x) {
  return sqrt(dot(k, x, x));
}

/* y -= factor x. */
static void subtract(struct stokes_krylov *k, double factor, const float *x, float *y) {
  const float f = (float)factor;
#pragma omp parallel for simd schedule(static)
  for (size_t i = 0; i < k->length; i++) y[i] -= f * x[i];
}

static void scale(struct stokes_krylov *k, double factor, float *x) {
  const float f = (float)factor;
#pragma omp parallel for simd schedule(static)
  for (size_t i = 0; i < k->length; i++) x[i] *= f;
}

int stokes_krylov_correct(struct stokes_krylov *k, double reduction, double *x, double *reached) {
  double(*h)[BASIS_MAX] = (double(*)[BASIS_MAX])k->columns;
  double cosine[BASIS_MAX], sine[BASIS_MAX], g[BASIS_MAX + 1];
  const double start = stokes_krylov_norm(k, k->basis);
  *reached = start > 0.0 ? 1.0 : 0.0;
  if (!(start > 0.0)) return 0;
  /* The first vector is not normalised, so that the residual is preserved if the correction is
   * abandoned. */
  const double unit = 1.0 / start;
  g[0] = start;
  int n = 0;
  while (n < k->basis_max && !(*reached <= reduction)) {
    if (interrupt_alone()) return 0;
    float *w = k->basis + (size_t)(n + 1) * k->length;
    k->precondition(k->system, k->basis + (size_t)n * k->length, w, k->work);
    if (interrupt_alone()) return 0;
    k->apply(k->system, k->work, w);
    if (n == 0) scale(k, unit, w);
    for (int i = 0; i <= n; i++) {
      const float *v = k->basis + (size_t)i * k->length;
      h[i][n] = dot(k, v, w) * (i == 0 ? unit : 1.0);
      subtract(k, h[i][n] * (i == 0 ? unit : 1.0), v, w);
    }
    h[n + 1][n] = stokes_krylov_norm(k, w);
    if (h[n + 1][n] > 0.0) scale(k, 1.0 / h[n + 1][n], w);
    for (int i = 0; i < n; i++) {
      const double upper = h[i][n];
      h[i][n] = cosine[i] * upper + sine[i] * h[i + 1][n];
      h[i + 1][n] = -sine[i] * upper + cosine[i] * h[i + 1][n];
    }
    const double length = hypot(h[n][n], h[n + 1][n]);
    if (!(length > 0.0)) break;
    cosine[n] = h[n][n] / length, sine[n] = h[n + 1][n] / length;
    h[n][n] = length;
    g[n + 1] = -sine[n] * g[n];
    g[n] *= cosine[n];
    n++;
    *reached = fabs(g[n]) / start;
  }
  if (n == 0 || interrupt_alone()) return 0;
  /* The remaining residual: g[n] times the last unit vector, rotated back. */
  double left[BASIS_MAX + 1] = {0.0};
  left[n] = g[n];
  for (int i = n - 1; i >= 0; i--) {
    left[i] = -sine[i] * left[i + 1];
    left[i + 1] *= cosine[i];
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int j = i + 1; j < n; j++) g[i] -= h[i][j] * g[j];
    g[i] /= h[i][i];
  }
  /* Both sums are formed in place, in the last and the first vector of the basis. */
  float *first = k->basis, *last = k->basis + (size_t)n * k->length;
  scale(k, left[n], last);
  for (int i = 0; i < n; i++)
    subtract(k, -left[i] * (i == 0 ? unit : 1.0), k->basis + (size_t)i * k->length, last);
  scale(k, g[0] * unit, first);
  for (int i = 1; i < n; i++) subtract(k, -g[i], k->basis + (size_t)i * k->length, first);
  float *scratch = n < k->basis_max ? last + k->length : first + k->length;
  k->precondition(k->system, first, scratch, k->work);
#pragma omp parallel for simd schedule(static)
  for (size_t i = 0; i < k->length; i++) x[i] += (double)k->work[i];
  memcpy(first, last, k->length * sizeof *first);
  return n;
}
