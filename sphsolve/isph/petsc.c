#include "sphsolve/isph/petsc.h"

#ifndef TOSUI_MPI

enum status isph_petsc_solve(struct isph *s) {
  (void)s;
  return STATUS_OK;
}
void isph_petsc_free(struct isph *s) {
  (void)s;
}

#else
#include <math.h>
#include <petscksp.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/isph/multigrid.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/matrix.h"

#define ITERATIONS_MAX 2000

/* Matrix rows to be passed to PETSc, in compressed form. */
struct rows {
  PetscInt *start, *column;
  PetscScalar *value;
  size_t room, entry_room;
};

struct isph_petsc {
  struct isph *state;
  Mat matrix;              /* isph_multiply */
  Mat interpolation, grid; /* the preconditioner of multigrid.h */
  Vec down, up;            /* vectors of its nodes */
  PC cycle;
  Mat assembled; /* instead: the matrix itself, for a preconditioner that PETSC_OPTIONS names */
  Vec load, solution;
  MatNullSpace constant;
  KSP solver;
  struct rows rows;
  double energy, error;
};

#define TRY_PETSC(call)                                                                            \
  do {                                                                                             \
    PetscErrorCode failed_ = (call);                                                               \
    if (failed_ != 0)                                                                              \
      TRY_FAIL(STATUS_RUN, "PETSc fails with error %d in the pressure solve", (int)failed_);       \
  } while (0)

/* Options of PETSc for the grid, unless the environment variable PETSC_OPTIONS sets others. */
static const char *const defaults[][2] = {
    {"-grid_pc_type", "hypre"},
    {"-grid_pc_hypre_type", "boomeramg"},
    {"-grid_pc_hypre_boomeramg_relax_type_coarse", "symmetric-SOR/Jacobi"},
    {"-pc_hypre_boomeramg_relax_type_coarse", "symmetric-SOR/Jacobi"},
};

static enum status start_petsc(void) {
  enum status status = STATUS_OK;
  PetscBool here;
  TRY_PETSC(PetscInitialized(&here));
  if (here) return STATUS_OK;
  PetscOptionsSetValue(NULL, "-no_signal_handler", "true");
  TRY_PETSC(PetscInitializeNoArguments());
  TRY_PETSC(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  for (size_t k = 0; k < sizeof defaults / sizeof *defaults; k++) {
    TRY_PETSC(PetscOptionsHasName(NULL, NULL, defaults[k][0], &here));
    if (!here) TRY_PETSC(PetscOptionsSetValue(NULL, defaults[k][0], defaults[k][1]));
  }
cleanup:
  return status;
}

/* Sorts a row by columns, and adds up the pairs of one particle with several images of another. */
static PetscInt merge_row(PetscInt *column, PetscScalar *value, PetscInt n) {
  PetscInt kept = 0;
  for (PetscInt k = 1; k < n; k++) {
    const PetscInt c = column[k];
    const PetscScalar v = value[k];
    PetscInt at = k;
    for (; at > 0 && column[at - 1] > c; at--) {
      column[at] = column[at - 1];
      value[at] = value[at - 1];
    }
    column[at] = c;
    value[at] = v;
  }
  for (PetscInt k = 1; k < n; k++) {
    if (column[k] == column[kept]) {
      value[kept] += value[k];
      continue;
    }
    column[++kept] = column[k];
    value[kept] = value[k];
  }
  return kept + 1;
}

static enum status reserve_rows(struct rows *rows, size_t n, size_t entries) {
  enum status status = STATUS_OK;
  if (n + 1 > rows->room) {
    TRY(memory_resize(&rows->start, n + n / 4 + 1, sizeof *rows->start, "pressure matrix"));
    rows->room = n + n / 4 + 1;
  }
  if (entries > rows->entry_room) {
    const size_t room = entries + entries / 8;
    TRY(memory_resize(&rows->column, room, sizeof *rows->column, "pressure matrix"));
    TRY(memory_resize(&rows->value, room, sizeof *rows->value, "pressure matrix"));
    rows->entry_room = room;
  }
  rows->start[0] = 0;
cleanup:
  return status;
}

static void add_row(const struct isph *s, struct rows *rows, size_t row, int n, const size_t *node,
                    const double *value, PetscInt *used) {
  for (int c = 0; c < n; c++) {
    rows->column[*used + c] = (PetscInt)multigrid_number(s, node[c], false);
    rows->value[*used + c] = value[c];
  }
  *used += merge_row(rows->column + *used, rows->value + *used, n);
  rows->start[row + 1] = *used;
}

/* Creates a matrix of the own rows [0, n); `columns`: number of own columns. */
static enum status make_matrix(const struct rows *rows, size_t n, size_t columns, Mat *matrix) {
  enum status status = STATUS_OK;
  TRY_PETSC(MatCreateMPIAIJWithArrays(PETSC_COMM_WORLD, (PetscInt)n, (PetscInt)columns,
                                      PETSC_DETERMINE, PETSC_DETERMINE, rows->start, rows->column,
                                      rows->value, matrix));
cleanup:
  return status;
}

static enum status assemble_particles(struct isph *s, struct isph_petsc *p) {
  enum status status = STATUS_OK;
  const size_t begin = s->local.begin, own = s->local.end - begin;
  struct rows *rows = &p->rows;
  size_t entries = own;
  PetscInt used = 0;
  for (size_t c = 0; c < s->chunk_count; c++) entries += s->chunks[c].pair_count;
  TRY(reserve_rows(rows, own, entries));
  for (size_t c = 0; c < s->chunk_count; c++) {
    const struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++) {
      PetscInt n = 0, *column = rows->column + used;
      PetscScalar *value = rows->value + used;
      column[n] = (PetscInt)ghosts_number(&s->local, i);
      value[n++] = s->diagonal[i];
      for (size_t q = s->pair_first[i], end = q + s->pair_number[i]; q < end; q++) {
        column[n] = (PetscInt)ghosts_number(&s->local, chunk->pair[q] & PAIR_MASK);
        value[n++] = -(double)chunk->matrix[q];
      }
      used += merge_row(column, value, n);
      rows->start[i - begin + 1] = used;
    }
  }
  TRY(make_matrix(rows, own, own, &p->assembled));
cleanup:
  return status;
}

/* Divides the nodes of the grid among the ranks that have the particles above them. */
static enum status assemble_grid(struct isph *s, struct isph_petsc *p) {
  enum status status = STATUS_OK;
  struct rows *rows = &p->rows;
  const size_t begin = s->local.begin, own = s->local.end - begin;
  size_t node[27], first = 0, end = multigrid_nodes(s), ranks, *partition = NULL;
  double value[27];
  const size_t here = own > 0 ? multigrid_row_before(s, s->position[begin]) : end;
  TRY(isph_gather(&here, 1, sizeof here, &partition, &ranks));
  /* a rank without particles begins where the next one does */
  for (size_t r = ranks - 1; r > 0; r--)
    if (s->local.partition[r] == s->local.partition[r + 1])
      partition[r] = r + 1 < ranks ? partition[r + 1] : end;
  for (size_t r = 1; r < ranks; r++) {
    if (r <= (size_t)ranks_own() && partition[r] > first) first = partition[r];
    if (r == (size_t)ranks_own() + 1) end = partition[r] > first ? partition[r] : first;
  }
  if (own == 0) first = end;
  const size_t nodes = end - first;
  PetscInt used = 0;
  TRY(reserve_rows(rows, own, 8 * own));
  for (size_t i = 0; i < own; i++) {
    const int n = multigrid_interpolation(s, i, node, value);
    add_row(s, rows, i, n, node, value, &used);
  }
  TRY(make_matrix(rows, own, nodes, &p->interpolation));
  TRY(reserve_rows(rows, nodes, 27 * nodes));
  used = 0;
  for (size_t i = 0; i < nodes; i++) {
    const int n = multigrid_row(s, multigrid_number(s, first + i, true), node, value);
    add_row(s, rows, i, n, node, value, &used);
  }
  TRY(make_matrix(rows, nodes, nodes, &p->grid));
  TRY_PETSC(MatCreateVecs(p->grid, &p->down, &p->up));
  TRY_PETSC(PCCreate(PETSC_COMM_WORLD, &p->cycle));
  TRY_PETSC(PCSetOptionsPrefix(p->cycle, "grid_"));
  TRY_PETSC(PCSetOperators(p->cycle, p->grid, p->grid));
  TRY_PETSC(PCSetFromOptions(p->cycle));
  TRY_PETSC(PCSetUp(p->cycle));
cleanup:
  memory_free(&partition);
  return status;
}

static void destroy_solver(struct isph_petsc *p) {
  KSPDestroy(&p->solver);
  PCDestroy(&p->cycle);
  Vec *const vectors[] = {&p->load, &p->solution, &p->down, &p->up};
  for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++) VecDestroy(vectors[k]);
  MatNullSpaceDestroy(&p->constant);
  Mat *const matrices[] = {&p->matrix, &p->assembled, &p->interpolation, &p->grid};
  for (size_t k = 0; k < sizeof matrices / sizeof *matrices; k++) MatDestroy(matrices[k]);
}

/* z = r/diagonal + P B P^T r */
static PetscErrorCode precondition(PC solver, Vec r, Vec z) {
  struct isph_petsc *p;
  PetscCall(PCShellGetContext(solver, &p));
  const struct isph *s = p->state;
  const double *from;
  double *to;
  PetscCall(MatMultTranspose(p->interpolation, r, p->down));
  PetscCall(PCApply(p->cycle, p->down, p->up));
  PetscCall(MatMult(p->interpolation, p->up, z));
  PetscCall(VecGetArrayRead(r, &from));
  PetscCall(VecGetArray(z, &to));
  for (size_t i = s->local.begin, k = 0; i < s->local.end; i++, k++)
    to[k] += from[k] / s->diagonal[i];
  PetscCall(VecRestoreArray(z, &to));
  return VecRestoreArrayRead(r, &from);
}

static PetscErrorCode multiply(Mat matrix, Vec x, Vec y) {
  struct isph *s;
  const double *from;
  double *to;
  PetscCall(MatShellGetContext(matrix, &s));
  const size_t begin = s->local.begin, bytes = (s->local.end - begin) * sizeof *to;
  PetscCall(VecGetArrayRead(x, &from));
  PetscCall(VecGetArray(y, &to));
  if (bytes > 0) memcpy(s->work[0] + begin, from, bytes);
  isph_multiply(s, s->work[0], s->work[1]);
  if (bytes > 0) memcpy(to, s->work[1] + begin, bytes);
  PetscCall(VecRestoreArray(y, &to));
  return VecRestoreArrayRead(x, &from);
}

/* Convergence test as in pressure.c: r.M^-1 r, whose root is PETSc's natural norm, over x.b. */
static PetscErrorCode test_convergence(KSP solver, PetscInt iteration, PetscReal norm,
                                       KSPConvergedReason *reason, void *context) {
  struct isph_petsc *p = context;
  PetscScalar whole;
  (void)solver;
  PetscCall(VecDot(p->solution, p->load, &whole));
  p->energy = fmax(whole, p->state->solve.energy);
  p->error = norm > 0 ? norm / sqrt(fmax(p->energy, 1e-300)) : norm;
  *reason = KSP_CONVERGED_ITERATING;
  if (!(p->error > p->state->scene->isph.tolerance))
    *reason = isnan(p->error) ? KSP_DIVERGED_NANORINF : KSP_CONVERGED_RTOL;
  else if (iteration >= ITERATIONS_MAX)
    *reason = KSP_DIVERGED_ITS;
  return 0;
}

static enum status make_solver(struct isph *s, struct isph_petsc *p) {
  enum status status = STATUS_OK;
  const PetscInt own = (PetscInt)(s->local.end - s->local.begin);
  PetscBool named;
  PC preconditioner;
  destroy_solver(p);
  TRY_PETSC(PetscOptionsHasName(NULL, NULL, "-pc_type", &named));
  TRY_PETSC(
      MatCreateShell(PETSC_COMM_WORLD, own, own, PETSC_DETERMINE, PETSC_DETERMINE, s, &p->matrix));
  TRY_PETSC(MatShellSetOperation(p->matrix, MATOP_MULT, (void (*)(void))multiply));
  TRY_PETSC(MatSetOption(p->matrix, MAT_SYMMETRIC, PETSC_TRUE));
  TRY_PETSC(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, own, PETSC_DETERMINE,
                                  s->source + s->local.begin, &p->load));
  TRY_PETSC(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, own, PETSC_DETERMINE,
                                  s->pressure + s->local.begin, &p->solution));
  TRY_PETSC(KSPCreate(PETSC_COMM_WORLD, &p->solver));
  TRY_PETSC(KSPSetType(p->solver, KSPCG));
  TRY_PETSC(KSPGetPC(p->solver, &preconditioner));
  if (named) {
    TRY(assemble_particles(s, p));
  } else {
    TRY(multigrid_build(s));
    TRY(assemble_grid(s, p));
    TRY_PETSC(PCSetType(preconditioner, PCSHELL));
    TRY_PETSC(PCShellSetContext(preconditioner, p));
    TRY_PETSC(PCShellSetApply(preconditioner, precondition));
  }
  TRY_PETSC(KSPSetOperators(p->solver, p->matrix, named ? p->assembled : p->matrix));
  if (s->closed) {
    TRY_PETSC(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_TRUE, 0, NULL, &p->constant));
    TRY_PETSC(MatSetNullSpace(p->matrix, p->constant));
  }
  TRY_PETSC(KSPSetFromOptions(p->solver));
  TRY_PETSC(KSPSetNormType(p->solver, KSP_NORM_NATURAL));
  TRY_PETSC(KSPSetInitialGuessNonzero(p->solver, PETSC_TRUE));
  TRY_PETSC(KSPSetConvergenceTest(p->solver, test_convergence, p, NULL));
cleanup:
  return status;
}

enum status isph_petsc_solve(struct isph *s) {
  enum status status = STATUS_OK;
  struct isph_solve *solve = &s->solve;
  PetscReal norm;
  PetscInt iterations;
  double start = clock_seconds();
  TRY(start_petsc());
  if (s->petsc == NULL) TRY(memory_allocate(&s->petsc, 1, sizeof *s->petsc, "the pressure solver"));
  struct isph_petsc *p = s->petsc;
  p->state = s;
  if (solve->fresh) TRY(make_solver(s, p));
  solve->fresh = false;
  if (s->closed) TRY_PETSC(MatNullSpaceRemove(p->constant, p->load));
  TRY_PETSC(VecNorm(p->load, NORM_2, &norm));
  solve->residual = 0;
  if (!(norm > 0)) {
    if (norm != 0)
      TRY_FAIL(STATUS_NUMERIC,
               "t = %.4g s: the pressure equation has no finite right-hand side; use a smaller "
               "isph.dt",
               s->time);
    TRY_PETSC(VecSet(p->solution, 0));
    goto cleanup;
  }
  TRY_PETSC(KSPSetUp(p->solver));
  s->seconds_setup += clock_seconds() - start;
  TRY_PETSC(KSPSolve(p->solver, p->load, p->solution));
  TRY_PETSC(KSPGetIterationNumber(p->solver, &iterations));
  solve->energy = p->energy;
  solve->residual = p->error;
  solve->iterations += (int)iterations;
  solve->iterations_total += (int)iterations;
  if (!(p->error <= 1e3 * s->scene->isph.tolerance))
    TRY(isph_solve_failed(s, p->error, (int)iterations));
  if (s->closed) TRY_PETSC(MatNullSpaceRemove(p->constant, p->solution));
cleanup:
  return status;
}

void isph_petsc_free(struct isph *s) {
  if (s->petsc == NULL) return;
  destroy_solver(s->petsc);
  memory_free(&s->petsc->rows.start);
  memory_free(&s->petsc->rows.column);
  memory_free(&s->petsc->rows.value);
  memory_free(&s->petsc);
}
#endif
