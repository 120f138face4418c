#include "sphsolve/solute/multigrid.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/cells.h"
#include "common/variants.h"

/* Row operations of the multigrid cycle (multigrid.h), its most expensive part: each row comprises
 * the cells along the first axis and is vectorised by the compiler. `at`: index of the first cell;
 * `half`: half of s; `flows`: whether there is a flow. Closed cells have inverse 0 and stay 0. */

#define RUN 256 /* cells processed at a time */
#define INLINE static inline __attribute__((always_inline))

/* Coefficients of a face for the neighbours at its high and its low side are G' - s F / 2 and G' +
 * s F / 2, with G' = max(G, |s F| / 2). */
INLINE float hybrid_conductance(float g, float f) {
  const float size = f < 0 ? -f : f;
  return g > size ? g : size;
}

/* Sum of the contributions of the six neighbours of each cell of a run. */
INLINE void neighbour_sum(const struct solute_cells *c, float half, bool flows, size_t at,
                          int count, const float *x, float *restrict sum) {
  for (int i = 0; i < count; i++) sum[i] = 0;
  for (int a = 0; a < 3; a++) {
    const size_t d = c->stride[a];
    const float *g = c->conductance[a] + at, *f = flows ? c->flux[a] + at : NULL, *here = x + at;
    const float *low = here - d;
    if (flows)
      for (int i = 0; i < count; i++) {
        const float up = half * f[(size_t)i + d], down = half * f[i];
        sum[i] += (hybrid_conductance(g[(size_t)i + d], up) - up) * here[(size_t)i + d] +
                  (hybrid_conductance(g[i], down) + down) * low[i];
      }
    else
      for (int i = 0; i < count; i++)
        sum[i] += g[(size_t)i + d] * here[(size_t)i + d] + g[i] * low[i];
  }
}

/* Inverse of the diagonal of the cycle's operator. */
TARGETS static void multigrid_row_inverse(const struct solute_cells *c, float half, bool flows,
                                          size_t at, float *inverse) {
  for (size_t p = at; p < at + (size_t)c->n[0]; p++) {
    float sum = 0;
    for (int a = 0; a < 3; a++) {
      const size_t up = p + c->stride[a];
      const float high = flows ? half * c->flux[a][up] : 0, low = flows ? half * c->flux[a][p] : 0;
      sum += hybrid_conductance(c->conductance[a][up], high) - high;
      sum += hybrid_conductance(c->conductance[a][p], low) + low;
    }
    inverse[p] = sum > 0 ? 1 / sum : 0;
  }
}

/* Gauss-Seidel relaxation of every other cell, beginning with the `first`. */
/* All cells of a run are computed, but only every other one is stored: vector operations need
 * contiguous cells. */
TARGETS static void multigrid_row_relax(const struct solute_cells *c, float half, bool flows,
                                        size_t at, int first, const float *inverse,
                                        const float *rest, float *x) {
  for (int begin = 0; begin < c->n[0]; begin += RUN, at += RUN) {
    const int count = c->n[0] - begin < RUN ? c->n[0] - begin : RUN;
    float value[RUN];
    neighbour_sum(c, half, flows, at, count, x, value);
    for (int i = 0; i < count; i++)
      value[i] = (rest[at + (size_t)i] + value[i]) * inverse[at + (size_t)i];
    for (int i = first; i < count; i += 2) x[at + (size_t)i] = value[i];
  }
}

/* out = rest - A' x. */
TARGETS static void multigrid_row_defect(const struct solute_cells *c, float half, bool flows,
                                         size_t at, const float *inverse, const float *rest,
                                         const float *x, float *out) {
  for (int begin = 0; begin < c->n[0]; begin += RUN, at += RUN) {
    const int count = c->n[0] - begin < RUN ? c->n[0] - begin : RUN;
    float value[RUN];
    neighbour_sum(c, half, flows, at, count, x, value);
    for (int i = 0; i < count; i++) {
      const size_t p = at + (size_t)i;
      out[p] = inverse[p] > 0 ? rest[p] + value[i] - x[p] / inverse[p] : 0;
    }
  }
}

/* Weighted sum of the four nearest coarse rows (9, 3, 3, 1), beginning one cell before the first.
 * `ones`: with 1 for the values of open cells. */
INLINE void weighted_rows(const float *y, size_t near, const ptrdiff_t steps[2], int from,
                          int count, bool ones, float *restrict row) {
  const float *a = y + near + from - 1, *b = a + steps[0], *c = a + steps[1],
              *d = a + steps[0] + steps[1];
  if (ones)
    for (int i = 0; i < count + 2; i++)
      row[i] = (float)((a[i] > 0 ? 9 : 0) + (b[i] > 0 ? 3 : 0) + (c[i] > 0 ? 3 : 0) +
                       (d[i] > 0 ? 1 : 0));
  else
    for (int i = 0; i < count + 2; i++) row[i] = 9 * a[i] + 3 * b[i] + 3 * c[i] + d[i];
}

/* Adds the interpolated correction of the coarser cells around the row. `near`: index of the first
 * cell of the nearest coarse row; `steps`: offsets from there to the next nearest row along the
 * second and third axes. The weights are 3/4 and 1/4 along each axis, normalised over the open
 * cells: share = 1 / the sum of their weights. */
TARGETS static void multigrid_row_prolong(const float *y, size_t near, const ptrdiff_t steps[2],
                                          int count, const float *share, float *x) {
  for (int begin = 0; begin < count; begin += RUN) {
    const int left = count - begin < RUN ? count - begin : RUN;
    float row[RUN / 2 + 2];
    weighted_rows(y, near, steps, begin / 2, (left + 1) / 2, false, row);
    for (int i = 0; i < left; i++) {
      const float low = row[i / 2 + (i & 1)], high = row[i / 2 + 1 + (i & 1)];
      x[begin + i] += share[begin + i] * (i & 1 ? 3 * low + high : low + 3 * high);
    }
  }
}

/* Computes that share from the inverse diagonals of fine and coarse cells. */
TARGETS static void multigrid_row_share(const float *coarse_inverse, size_t near,
                                        const ptrdiff_t steps[2], int count, const float *inverse,
                                        float *share) {
  for (int begin = 0; begin < count; begin += RUN) {
    const int left = count - begin < RUN ? count - begin : RUN;
    float row[RUN / 2 + 2];
    weighted_rows(coarse_inverse, near, steps, begin / 2, (left + 1) / 2, true, row);
    for (int i = 0; i < left; i++) {
      // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): weighted_rows has filled it
      const float low = row[i / 2 + (i & 1)], high = row[i / 2 + 1 + (i & 1)];
      const float sum = i & 1 ? 3 * low + high : low + 3 * high;
      share[begin + i] = inverse[begin + i] > 0 && sum > 0 ? 1 / sum : 0;
    }
  }
}

#define BASIS 30
#define ROUNDS 20
#define SWEEPS 1 /* before and after the coarse correction */
#define SWEEPS_COARSEST 8

#define FOR_ROWS(c)                                                                                \
  for (int k = 0; k < (c)->n[2]; k++)                                                              \
    for (int j = 0; j < (c)->n[1]; j++)

static bool flows(const struct solute_solver *solver, int level) {
  return solver->s > 0 && solver->cells[level].flux[0] != NULL;
}

/* Index of the coarse row in which the row (j, k) lies, and offsets to its neighbours
 * (multigrid_row_prolong). */
static size_t coarse_row(const struct solute_cells *coarse, int j, int k, ptrdiff_t steps[2]) {
  steps[0] = (j & 1 ? 1 : -1) * (ptrdiff_t)coarse->stride[1];
  steps[1] = (k & 1 ? 1 : -1) * (ptrdiff_t)coarse->stride[2];
  return solute_cells_at(coarse, 0, j / 2, k / 2);
}

static void set_inverse(struct solute_solver *solver, int level) {
  const struct solute_cells *c = &solver->cells[level];
  float *inverse = solver->inverse[level];
#pragma omp parallel for schedule(static)
  FOR_ROWS(c)
  multigrid_row_inverse(c, (float)(0.5 * solver->s), flows(solver, level),
                        solute_cells_at(c, 0, j, k), inverse);
  solute_cells_wrap(c, inverse);
}

static void set_share(struct solute_solver *solver, int level) {
  const struct solute_cells *c = &solver->cells[level];
  const float *coarse_inverse = solver->inverse[level + 1];
#pragma omp parallel for schedule(static)
  FOR_ROWS(c) {
    ptrdiff_t steps[2];
    const size_t near = coarse_row(c + 1, j, k, steps), at = solute_cells_at(c, 0, j, k);
    multigrid_row_share(coarse_inverse, near, steps, c->n[0], solver->inverse[level] + at,
                        solver->share[level] + at);
  }
}

void solute_solver_set(struct solute_solver *solver, double s) {
  solver->s = s;
  for (int l = 0; l < solver->level_count; l++) set_inverse(solver, l);
  for (int l = 0; l + 1 < solver->level_count; l++) set_share(solver, l);
}

/* Updates the ghost cells at the rims of one plane, and of the whole plane if it is the first or
 * last. */
static void wrap_plane(const struct solute_cells *c, int k, float *x) {
  const size_t s1 = c->stride[1], s2 = c->stride[2];
  const size_t nx = (size_t)c->n[0], ny = (size_t)c->n[1], nz = (size_t)c->n[2];
  float *plane = x + (size_t)(k + 1) * s2;
  for (size_t j = 1; j <= ny; j++) {
    plane[j * s1] = plane[j * s1 + nx];
    plane[j * s1 + nx + 1] = plane[j * s1 + 1];
  }
  memcpy(plane, plane + ny * s1, s1 * sizeof *x);
  memcpy(plane + (ny + 1) * s1, plane + s1, s1 * sizeof *x);
  if (k == 0) memcpy(x + (nz + 1) * s2, plane, s2 * sizeof *x);
  if (k + 1 == c->n[2]) memcpy(x, plane, s2 * sizeof *x);
}

/* One relaxation sweep through the planes in the direction of the flow. */
static void sweep(const struct solute_solver *solver, int level, const float *rest, float *x) {
  const struct solute_cells *c = &solver->cells[level];
  const float *inverse = solver->inverse[level];
  const float half = (float)(0.5 * solver->s);
  const bool flow = flows(solver, level);
#pragma omp parallel if (c->size > 20000)
  for (int step = 0; step < c->n[2]; step++) {
    const int k = solver->down ? c->n[2] - 1 - step : step;
    for (int colour = 0; colour < 2; colour++) {
#pragma omp for schedule(static)
      for (int j = 0; j < c->n[1]; j++)
        multigrid_row_relax(c, half, flow, solute_cells_at(c, 0, j, k), (j + k + colour) & 1,
                            inverse, rest, x);
#pragma omp single
      wrap_plane(c, k, x);
    }
  }
}

/* Defect rest - A' x with the cycle's operator. */
static void defect(const struct solute_solver *solver, int level, const float *rest, const float *x,
                   float *out) {
  const struct solute_cells *c = &solver->cells[level];
#pragma omp parallel for schedule(static)
  FOR_ROWS(c)
  multigrid_row_defect(c, (float)(0.5 * solver->s), flows(solver, level),
                       solute_cells_at(c, 0, j, k), solver->inverse[level], rest, x, out);
}

/* Restriction: sums over the fine cells of each coarse cell. */
static void restrict_sum(const struct solute_cells *f, const struct solute_cells *c, const float *x,
                         float *y) {
#pragma omp parallel for schedule(static)
  for (int k = 0; k < c->n[2]; k++)
    for (int j = 0; j < c->n[1]; j++)
      for (int i = 0; i < c->n[0]; i++) {
        float sum = 0;
        for (int o = 0; o < 8; o++) {
          const int a = 2 * i + (o & 1), b = 2 * j + (o >> 1 & 1), d = 2 * k + (o >> 2);
          if (a < f->n[0] && b < f->n[1] && d < f->n[2]) sum += x[solute_cells_at(f, a, b, d)];
        }
        y[solute_cells_at(c, i, j, k)] = sum;
      }
}

/* Prolongation: x += the interpolated coarse correction. */
static void prolong_add(const struct solute_solver *solver, int level, float *x) {
  const struct solute_cells *c = &solver->cells[level];
#pragma omp parallel for schedule(static)
  FOR_ROWS(c) {
    ptrdiff_t steps[2];
    const size_t near = coarse_row(c + 1, j, k, steps), at = solute_cells_at(c, 0, j, k);
    multigrid_row_prolong(solver->x[level + 1], near, steps, c->n[0], solver->share[level] + at,
                          x + at);
  }
}

/* V-cycle from x = 0. */
static void cycle(const struct solute_solver *solver, int level, const float *rest, float *x) {
  const struct solute_cells *c = &solver->cells[level];
  memset(x, 0, c->size * sizeof *x);
  const bool last = level + 1 == solver->level_count;
  for (int i = 0; i < (last ? SWEEPS_COARSEST : SWEEPS); i++) sweep(solver, level, rest, x);
  if (last) return;
  defect(solver, level, rest, x, solver->work[level]);
  const struct solute_cells *coarse = &solver->cells[level + 1];
  restrict_sum(c, coarse, solver->work[level], solver->rest[level + 1]);
  cycle(solver, level + 1, solver->rest[level + 1], solver->x[level + 1]);
  prolong_add(solver, level, x);
  solute_cells_wrap(c, x);
  for (int i = 0; i < SWEEPS; i++) sweep(solver, level, rest, x);
}

static void apply(void *system, const float *x, float *y) {
  const struct solute_solver *solver = system;
  solute_cells_apply(&solver->cells[0], solver->s, x, y);
}

static void precondition(void *system, const float *x, float *work, float *y) {
  (void)work;
  cycle(system, 0, x, y);
}

enum status solute_solver_build(const struct solute_flow *flow, const int axis[3], bool down,
                                int coarsenings, struct solute_solver *s) {
  enum status status = STATUS_OK;
  *s = (struct solute_solver){.down = down};
  TRY(solute_cells_of_flow(flow, axis, &s->cells[0]));
  for (; coarsenings > 0; coarsenings--) {
    struct solute_cells fine = s->cells[0];
    status = solute_cells_coarsen(&fine, &s->cells[0]);
    solute_cells_free(&fine);
    if (status != STATUS_OK) goto cleanup;
  }
  s->level_count = 1;
  for (;;) {
    const int l = s->level_count;
    const struct solute_cells *fine = &s->cells[l - 1];
    const int most = (int)fmax(fmax(fine->n[0], fine->n[1]), fine->n[2]);
    if (most <= 3 || l == SOLUTE_LEVELS) break;
    TRY(solute_cells_coarsen(fine, &s->cells[l]));
    s->level_count++;
  }
  for (int l = 0; l < s->level_count; l++) {
    const size_t size = s->cells[l].size;
    TRY(memory_allocate(&s->inverse[l], size, sizeof(float), "diagonal of the closure problem"));
    TRY(memory_allocate(&s->work[l], size, sizeof(float), "multigrid"));
    if (l + 1 < s->level_count)
      TRY(memory_allocate(&s->share[l], size, sizeof(float), "multigrid"));
    if (l == 0) continue;
    TRY(memory_allocate(&s->x[l], size, sizeof(float), "multigrid"));
    TRY(memory_allocate(&s->rest[l], size, sizeof(float), "multigrid"));
  }
  TRY(stokes_krylov_build(s->cells[0].size, BASIS, &s->krylov));
  s->krylov.alone = true;
  s->krylov.system = s;
  s->krylov.apply = apply;
  s->krylov.precondition = precondition;
  solute_solver_set(s, 0);
cleanup:
  if (status != STATUS_OK) solute_solver_free(s);
  return status;
}

void solute_solver_free(struct solute_solver *s) {
  for (int l = 0; l < SOLUTE_LEVELS; l++) {
    solute_cells_free(&s->cells[l]);
    MEMORY_FREE(&s->inverse[l], &s->share[l], &s->x[l], &s->rest[l], &s->work[l]);
  }
  stokes_krylov_free(&s->krylov);
}

static double norm(const struct solute_cells *c, const double *x) {
  double sum = 0;
  for (int k = 0; k < c->n[2]; k++)
    for (int j = 0; j < c->n[1]; j++)
      for (int i = 0; i < c->n[0]; i++) {
        const double v = x[solute_cells_at(c, i, j, k)];
        sum += v * v;
      }
  return sqrt(sum);
}

enum status solute_solver_solve(struct solute_solver *s, const double *source, double tolerance,
                                double stalled, double *b, int *iterations, double *reached) {
  const struct solute_cells *c = &s->cells[0];
  const double scale = norm(c, source);
  double before = INFINITY;
  *iterations = 0, *reached = 0;
  if (!(scale > 0)) return STATUS_OK;
  for (int round = 0; round < ROUNDS; round++) {
    double shrunk;
    solute_cells_wrap_exact(c, b);
    solute_cells_residual(c, s->s, source, b, s->krylov.basis);
    *reached = stokes_krylov_norm(&s->krylov, s->krylov.basis) / scale;
    if (*reached <= tolerance) return STATUS_OK;
    if (!(*reached < STALLED_RATIO * before)) break; /* no further progress */
    before = *reached;
    *iterations +=
        stokes_krylov_correct(&s->krylov, fmax(0.5 * tolerance / *reached, 1e-4), b, &shrunk);
    const double mean = solute_cells_mean(c, b);
    for (size_t i = 0; i < c->size; i++) b[i] -= mean;
  }
  if (*reached <= stalled) return STATUS_OK;
  return FAIL(STATUS_NUMERIC,
              "the closure problem at Pe = %.3g of a cell was solved to %.1e and no further; a "
              "finer lattice of the flow helps",
              s->s, *reached);
}
