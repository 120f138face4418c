#include "sphsolve/isph/isph_petsc.h"

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

#include "common/log.h"
#include "common/memory.h"

#define ITERATIONS_MAX 2000

struct isph_petsc {
  Mat matrix;
  Vec load, solution;
  MatNullSpace constant;
  KSP solver;
  PetscInt *row, *column;
  PetscScalar *value;
  size_t row_room, entry_room;
  const struct isph *state;
  double energy, error;
};

#define TRY_PETSC(call)                                                                            \
  do {                                                                                             \
    PetscErrorCode failed_ = (call);                                                               \
    if (failed_ != 0)                                                                              \
      TRY_FAIL(STATUS_RUN, "PETSc fails with error %d in the pressure solve", (int)failed_);       \
  } while (0)

/* What PETSc does unless the environment variable PETSC_OPTIONS says otherwise. */
static const char *const defaults[][2] = {
    {"-ksp_type", "cg"},
    {"-pc_type", "hypre"},
    {"-pc_hypre_type", "boomeramg"},
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

/* A row: columns in order, pairs of one particle with several images of another added up. */
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

static enum status make_matrix(const struct isph *s, struct isph_petsc *p) {
  enum status status = STATUS_OK;
  const size_t begin = s->share.begin, own = s->share.end - begin;
  size_t entries = own;
  PetscInt used = 0;
  for (size_t c = 0; c < s->chunk_count; c++) entries += s->chunks[c].pair_count;
  if (own + 1 > p->row_room) {
    p->row_room = own + own / 4 + 1;
    TRY(memory_resize(&p->row, p->row_room, sizeof *p->row, "pressure matrix"));
  }
  if (entries > p->entry_room) {
    p->entry_room = entries + entries / 8;
    TRY(memory_resize(&p->column, p->entry_room, sizeof *p->column, "pressure matrix"));
    TRY(memory_resize(&p->value, p->entry_room, sizeof *p->value, "pressure matrix"));
  }
  p->row[0] = 0;
  for (size_t c = 0; c < s->chunk_count; c++) {
    const struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++) {
      PetscInt n = 0, *column = p->column + used;
      PetscScalar *value = p->value + used;
      column[n] = (PetscInt)i;
      value[n++] = s->diagonal[i];
      for (size_t q = s->pair_first[i], end = q + s->pair_number[i]; q < end; q++) {
        column[n] = (PetscInt)(chunk->pair[q] & PAIR_MASK);
        value[n++] = -(double)chunk->matrix[q];
      }
      used += merge_row(column, value, n);
      p->row[i - begin + 1] = used;
    }
  }
  TRY_PETSC(MatCreateMPIAIJWithArrays(PETSC_COMM_WORLD, (PetscInt)own, (PetscInt)own,
                                      (PetscInt)s->count, (PetscInt)s->count, p->row, p->column,
                                      p->value, &p->matrix));
  TRY_PETSC(MatSetOption(p->matrix, MAT_SPD, s->closed ? PETSC_FALSE : PETSC_TRUE));
cleanup:
  return status;
}

static void drop(struct isph_petsc *p) {
  KSPDestroy(&p->solver);
  VecDestroy(&p->load);
  VecDestroy(&p->solution);
  MatNullSpaceDestroy(&p->constant);
  MatDestroy(&p->matrix);
}

/* As in isph_pressure.c: r.M^-1 r, whose root PETSc's natural norm is, over x.b. */
static PetscErrorCode judge(KSP solver, PetscInt iteration, PetscReal norm,
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
  const PetscInt own = (PetscInt)(s->share.end - s->share.begin), all = (PetscInt)s->count;
  drop(p);
  TRY(make_matrix(s, p));
  TRY_PETSC(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, own, all, s->source + s->share.begin,
                                  &p->load));
  TRY_PETSC(VecCreateMPIWithArray(PETSC_COMM_WORLD, 1, own, all, s->pressure + s->share.begin,
                                  &p->solution));
  if (s->closed) {
    TRY_PETSC(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_TRUE, 0, NULL, &p->constant));
    TRY_PETSC(MatSetNullSpace(p->matrix, p->constant));
  }
  TRY_PETSC(KSPCreate(PETSC_COMM_WORLD, &p->solver));
  TRY_PETSC(KSPSetOperators(p->solver, p->matrix, p->matrix));
  TRY_PETSC(KSPSetFromOptions(p->solver));
  TRY_PETSC(KSPSetNormType(p->solver, KSP_NORM_NATURAL));
  TRY_PETSC(KSPSetInitialGuessNonzero(p->solver, PETSC_TRUE));
  TRY_PETSC(KSPSetConvergenceTest(p->solver, judge, p, NULL));
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
  if (s->petsc == NULL)
    TRY(memory_allocate(&s->petsc, 1, sizeof *s->petsc, "the pressure solver"));
  struct isph_petsc *p = s->petsc;
  p->state = s;
  /* The second solve of a step has the first one's matrix. */
  if (!solve->again) TRY(make_solver(s, p));
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
    TRY_FAIL(STATUS_NUMERIC,
             "t = %.4g s: the pressure solve stands at a relative error of %.2g after "
             "%d iterations; use a smaller isph.dt",
             s->time, p->error, (int)iterations);
  if (s->closed) TRY_PETSC(MatNullSpaceRemove(p->constant, p->solution));
cleanup:
  return status;
}

void isph_petsc_free(struct isph *s) {
  if (s->petsc == NULL) return;
  drop(s->petsc);
  memory_free(&s->petsc->row);
  memory_free(&s->petsc->column);
  memory_free(&s->petsc->value);
  memory_free(&s->petsc);
}
#endif
