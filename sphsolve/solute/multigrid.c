#include "sphsolve/solute/multigrid.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/multigrid_rows.h"

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
