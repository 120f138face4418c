#include "sphsolve/stokes/solver/precondition.h"
#include "sphsolve/stokes/constants.h"

#include <math.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "sphsolve/geometry/thin_wall.h"
#include "sphsolve/stokes/effects/soil_drag.h"
#include "sphsolve/stokes/solver/darcy.h"
#include "sphsolve/stokes/solver/sums.h"

#define KAPPA_ITERATIONS 400
#define SOIL_SWEEPS 3
/* Jacobi sweeps after the coarse correction of the velocities. With one sweep, open fibres need
 * twice the iterations; a third one gains nothing. */
#define VELOCITY_SWEEPS 2

/* kappa += alpha d, r -= alpha Ad; returns r D^-1 r. */
static double step_kappa(struct stokes_preconditioner *pc, float alpha, const float *d,
                         const float *Ad, float *r, double *partial) {
  const float *diagonal = pc->op->diagonal;
  const size_t n = pc->op->n;
#pragma omp parallel for schedule(static)
  for (size_t b = 0; b < stokes_sum_blocks(n); b++) {
    const size_t end = stokes_sum_block_end(b, n);
    double sum = 0.0;
#pragma omp simd reduction(+ : sum)
    for (size_t i = b * STOKES_SUM_BLOCK; i < end; i++) {
      pc->kappa[i] += alpha * d[i];
      r[i] -= alpha * Ad[i];
      sum += (double)r[i] * (double)r[i] / (double)diagonal[i];
    }
    partial[b] = sum;
  }
  return ranks_sum(stokes_sum_total(n, partial));
}

/* Solves A kappa = 1 by diagonally preconditioned conjugate gradients; an error of a few per cent
 * is sufficient. */
static enum status solve_kappa(struct stokes_preconditioner *pc) {
  enum status status = STATUS_OK;
  struct stokes_operator *op = pc->op;
  const size_t n = op->n;
  float *r = NULL, *d = NULL, *Ad = NULL;
  double *partial = NULL;
  TRY(memory_allocate(&r, n, sizeof *r, "preconditioner"));
  TRY(memory_allocate(&d, n, sizeof *d, "preconditioner"));
  TRY(memory_allocate(&Ad, n, sizeof *Ad, "preconditioner"));
  TRY(memory_allocate(&partial, stokes_sum_blocks(n), sizeof *partial, "preconditioner"));
#pragma omp parallel for simd schedule(static)
  for (size_t i = 0; i < n; i++) {
    r[i] = 1.0f;
    d[i] = r[i] / op->diagonal[i];
  }
  const double start = ranks_sum(stokes_sum_dot(n, r, d, partial));
  double rho = start;
  for (int it = 0; it < KAPPA_ITERATIONS && rho > KAPPA_TOLERANCE * KAPPA_TOLERANCE * start; it++) {
    TRY(interrupt_look());
    stokes_operator_apply_viscous(op, -1, d, Ad);
    const float alpha = (float)(rho / ranks_sum(stokes_sum_dot(n, d, Ad, partial)));
    const double next = step_kappa(pc, alpha, d, Ad, r, partial);
    const float beta = (float)(next / rho);
#pragma omp parallel for simd schedule(static)
    for (size_t i = 0; i < n; i++) d[i] = r[i] / op->diagonal[i] + beta * d[i];
    rho = next;
  }
  /* Soil of low permeability has no weight in that norm; there kappa is improved by Jacobi
   * sweeps. */
  for (int sweep = 0; op->soil && sweep < SOIL_SWEEPS; sweep++) {
    stokes_operator_apply_viscous(op, -1, pc->kappa, Ad);
    for (size_t i = 0; i < n; i++)
      if (op->soil->relative[i] < 1.0f) pc->kappa[i] += (1.0f - Ad[i]) / op->diagonal[i];
  }
#pragma omp parallel for simd schedule(static)
  for (size_t i = 0; i < n; i++) {
    const float least = 0.5f / op->diagonal[i];
    if (!(pc->kappa[i] > least)) pc->kappa[i] = least;
  }
  for (size_t i = 0; op->soil && i < n; i++) {
    const double m = (double)op->soil->relative[i];
    pc->darcy[i] = m < 1.0 ? fminf(pc->kappa[i], (float)stokes_soil_permeability(m)) : pc->kappa[i];
  }
cleanup:
  MEMORY_FREE(&r, &d, &Ad, &partial);
  return status;
}

/* Sum of a packed vector (times kappa) over the blocks of the first coarse level. */
static void restrict_packed(const struct stokes_preconditioner *pc, const float *x, bool weigh,
                            const struct stokes_multigrid_level *coarse, float *out) {
  const struct stokes_grid *grid = pc->op->grid;
  const size_t ny = grid->size[1], nz = stokes_grid_planes(grid);
#pragma omp parallel for schedule(static)
  for (size_t c = coarse->size[1] * coarse->begin; c < coarse->size[1] * coarse->end; c++) {
    const size_t J = c % coarse->size[1], K = c / coarse->size[1];
    float *sum = out + c * coarse->size[0];
    memset(sum, 0, coarse->size[0] * sizeof *sum);
    for (size_t k = 2 * K; k < 2 * K + 2 && k < nz; k++)
      for (size_t j = 2 * J; j < 2 * J + 2 && j < grid->columns; j++) {
        const size_t row = k * ny + j;
        size_t at = grid->row_start[row];
        for (size_t chunk = 0; chunk < grid->chunks; chunk++)
          for (unsigned bits = grid->mask[row * grid->chunks + chunk]; bits; bits &= bits - 1) {
            const size_t i = chunk * STOKES_LANES + (size_t)__builtin_ctz(bits);
            sum[i / 2] += weigh ? x[at] * pc->kappa[at] : x[at];
            at++;
          }
      }
  }
}

/* x += value of the block (times kappa). */
static void prolong_packed(const struct stokes_preconditioner *pc,
                           const struct stokes_multigrid_level *coarse, bool weigh, float *x) {
  const struct stokes_grid *grid = pc->op->grid;
#pragma omp parallel for schedule(static)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    const size_t j = row % grid->size[1], k = row / grid->size[1];
    if (stokes_grid_is_y_image(grid, row)) continue;
    const float *from = coarse->u + ((k / 2) * coarse->size[1] + j / 2) * coarse->size[0];
    size_t at = grid->row_start[row];
    for (size_t chunk = 0; chunk < grid->chunks; chunk++)
      for (unsigned bits = grid->mask[row * grid->chunks + chunk]; bits; bits &= bits - 1) {
        const float u = from[(chunk * STOKES_LANES + (size_t)__builtin_ctz(bits)) / 2];
        x[at] += weigh ? u * pc->kappa[at] : u;
        at++;
      }
  }
}

/* Adds the contribution of a row to the couplings between its blocks and the next ones. kappa and
 * darcy (the permeability of the pressure equation): unpacked, by lattice site. */
static void add_row(struct stokes_preconditioner *pc, const float *kappa, const float *darcy,
                    size_t row) {
  const struct stokes_operator *op = pc->op;
  const struct stokes_grid *grid = op->grid;
  const size_t nx = grid->size[0], *size = grid->size;
  const size_t j = row % size[1], k = row / size[1];
  struct stokes_multigrid_level *v = &pc->velocity.levels[0], *p = &pc->pressure.levels[0];
  for (size_t i = 0; i < nx && (i > 0 || !interrupt_alone()); i++) {
    const float here = kappa[row * grid->stride + i];
    if (here == 0.0f) continue;
    const size_t at[3] = {i, j, k};
    const size_t c = ((k / 2) * v->size[1] + j / 2) * v->size[0] + i / 2;
    /* An odd pressure is zero on the mirror planes, half a spacing away. */
    if (grid->mirrored && grid->parity[3] < 0.0f && (k == 0 || k + 1 == stokes_grid_planes(grid)))
      p->mass[c] += (float)(1.0 / (op->stencil->spacing[2] * op->stencil->spacing[2])) *
                    darcy[row * grid->stride + i];
    for (int a = 0; a < op->stencil->axis_count; a++) {
      const int axis = op->stencil->axes[a];
      const bool edge = at[axis] % 2 == 1 || at[axis] + 1 == size[axis];
      if (!edge || v->size[axis] == 1 || thin_wall_on_face(op->lattice, row * nx + i, axis))
        continue;
      const float t = (float)(0.5 / (op->stencil->spacing[axis] * op->stencil->spacing[axis]));
      if (grid->mirrored && axis == 2 && k + 1 == stokes_grid_planes(grid)) continue;
      if (stokes_grid_is_halved(grid) && axis == 1 && j + 1 == grid->columns) continue;
      size_t next[3] = {i, j, k};
      next[axis] = at[axis] + 1 < size[axis] ? at[axis] + 1 : 0;
      const size_t beside = (next[2] * size[1] + next[1]) * grid->stride + next[0];
      const float there = kappa[beside];
      if (there == 0.0f) continue;
      v->face[axis][c] += t * here * there;
      if (op->soil) { /* in series, because darcy jumps at the surface of soil */
        const float low = darcy[row * grid->stride + i], high = darcy[beside];
        p->face[axis][c] += t * 2.0f * low * high / (low + high);
      } else {
        p->face[axis][c] += t * 0.5f * (here + there);
      }
    }
  }
}

/* Computes the couplings between neighbouring blocks from the faces between active sites. */
static enum status fill_levels(struct stokes_preconditioner *pc) {
  struct stokes_operator *op = pc->op;
  const struct stokes_grid *grid = op->grid;
  const size_t *size = grid->size;
  struct stokes_multigrid_level *v = &pc->velocity.levels[0];
  float *kappa = op->field, *darcy = kappa; /* by lattice site */
#pragma omp parallel for schedule(static)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
    if (!stokes_grid_is_y_image(grid, row))
      op->rows->unpack(grid->mask + row * grid->chunks, grid->chunks,
                       pc->kappa + grid->row_start[row], kappa + row * grid->stride);
  if (RANKS) slabs_post(&grid->slabs, 0, kappa, size[1] * grid->stride * sizeof *kappa, 1);
  ranks_wait();
  if (op->soil) {
    darcy = op->field + grid->rows * grid->stride;
#pragma omp parallel for schedule(static)
    for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
      op->rows->unpack(grid->mask + row * grid->chunks, grid->chunks,
                       pc->darcy + grid->row_start[row], darcy + row * grid->stride);
    if (RANKS) slabs_post(&grid->slabs, 0, darcy, size[1] * grid->stride * sizeof *darcy, 1);
    ranks_wait();
  }
  restrict_packed(pc, pc->kappa, false, v, v->mass);
  /* Both planes of a layer of blocks are summed by one thread, row by row: a fixed order of
   * summation. */
  const size_t begin = stokes_grid_begin(grid), end = stokes_grid_end(grid);
#pragma omp parallel for schedule(static)
  for (size_t first = begin; first < end; first += 2 * size[1])
    for (size_t row = first; row < end && row < first + 2 * size[1]; row++)
      if (!stokes_grid_is_y_image(grid, row)) add_row(pc, kappa, darcy, row);
  if (!interrupt_alone()) stokes_multigrid_coarsen(&pc->velocity);
  if (!interrupt_alone()) stokes_multigrid_coarsen(&pc->pressure);
  return interrupt_look();
}

enum status stokes_preconditioner_build(struct stokes_operator *op,
                                        struct stokes_preconditioner *pc) {
  enum status status = STATUS_OK;
  memset(pc, 0, sizeof *pc);
  pc->op = op;
  const size_t solved[3] = {op->grid->size[0], op->grid->columns, stokes_grid_planes(op->grid)};
  size_t coarse[3];
  for (int a = 0; a < 3; a++) coarse[a] = (solved[a] + 1) / 2;
  TRY(memory_allocate(&pc->kappa, op->n, sizeof *pc->kappa, "preconditioner"));
  if (op->soil) TRY(memory_allocate(&pc->darcy, op->n, sizeof *pc->darcy, "preconditioner"));
  TRY(solve_kappa(pc));
  const int shared = STOKES_SHARED_LEVELS - 1;
  TRY(stokes_multigrid_build(coarse, &op->grid->slabs, shared, &pc->velocity));
  TRY(stokes_multigrid_build(coarse, &op->grid->slabs, shared, &pc->pressure));
  TRY(fill_levels(pc));
  return STATUS_OK;
cleanup:
  stokes_preconditioner_free(pc);
  return status;
}

void stokes_preconditioner_free(struct stokes_preconditioner *pc) {
  MEMORY_FREE(&pc->kappa, &pc->darcy);
  stokes_multigrid_free(&pc->velocity);
  stokes_multigrid_free(&pc->pressure);
}

/* Subtracts the mean. A constant pressure has no effect, but in single precision it would hide the
 * small differences that matter in soil. Odd pressures have no mean. */
static void subtract_mean(const struct stokes_preconditioner *pc, float *p) {
  const struct stokes_grid *grid = pc->op->grid;
  double sum = 0.0;
  if (grid->mirrored && grid->parity[3] < 0.0f) return;
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    double own = 0.0;
    for (size_t i = grid->row_start[row]; i < grid->row_start[row + 1]; i++) own += (double)p[i];
    sum += stokes_grid_weight(grid, row) * own;
  }
  const float mean = (float)(ranks_sum(sum) / (double)grid->flowing);
#pragma omp parallel for simd schedule(static)
  for (size_t i = 0; i < pc->op->n; i++) p[i] -= mean;
}

/* Over distances shorter than a pore the Schur complement is of order one; in soil it is of order
 * M, the mobility relative to that of a pore (effects/soil_drag.h), since for wavelengths of a few
 * sites the wide gradient and the stabilisation leave a twentieth of Darcy's law there. The local
 * part is therefore r without soil, and LOCAL_SOIL r / M with soil
 * (docs/physics/stokes.md). */
#define LOCAL_SOIL 2.0f

/* p = S~^-1 r: a two-grid cycle for Darcy's law, with a Jacobi sweep before and after the coarse
 * levels, plus the local part. */
static void solve_pressure(struct stokes_preconditioner *pc, const float *r, float *left,
                           float *p) {
  struct stokes_operator *op = pc->op;
  struct stokes_multigrid_level *coarse = &pc->pressure.levels[0];
  stokes_darcy_begin(op, op->soil ? pc->darcy : pc->kappa);
  stokes_darcy_start(op, r, p);
  stokes_darcy_residual(op, r, p, left);
  restrict_packed(pc, left, false, coarse, coarse->b);
  stokes_multigrid_cycle(&pc->pressure, 2);
  prolong_packed(pc, coarse, false, p);
  stokes_darcy_smooth(op, r, p);
  if (op->soil) { /* also on a rank without sites */
    const float *relative = op->soil->relative;
#pragma omp parallel for simd schedule(static)
    for (size_t i = 0; i < op->n; i++) p[i] += LOCAL_SOIL * r[i] / relative[i];
    return;
  }
#pragma omp parallel for simd schedule(static)
  for (size_t i = 0; i < op->n; i++) p[i] += r[i];
}

/* y = A~^-1 x for one velocity component: coarse correction, then Jacobi sweeps. */
static void solve_velocity(struct stokes_preconditioner *pc, int axis, const float *x,
                           float *product, float *y) {
  struct stokes_operator *op = pc->op;
  struct stokes_multigrid_level *coarse = &pc->velocity.levels[0];
  restrict_packed(pc, x, true, coarse, coarse->b);
  stokes_multigrid_cycle(&pc->velocity, 1);
  memset(y, 0, op->n * sizeof *y);
  prolong_packed(pc, coarse, true, y);
  for (int sweep = 0; sweep < VELOCITY_SWEEPS; sweep++) {
    stokes_operator_apply_viscous(op, axis, y, product);
#pragma omp parallel for simd schedule(static)
    for (size_t i = 0; i < op->n; i++)
      y[i] += (float)DAMPING * (x[i] - product[i]) / op->diagonal[i];
  }
}

void stokes_preconditioner_apply(struct stokes_preconditioner *pc, const float *x, float *work,
                                 float *y) {
  struct stokes_operator *op = pc->op;
  const size_t n = op->n, axes = (size_t)op->stencil->axis_count;
  float *p = y + axes * n, *r = work, *product = work + axes * n;
  const float *scale = op->soil ? op->soil->row_scale : NULL, *continuity = x + axes * n;
  if (op->soil) { /* also on a rank without sites, which has no scale */
#pragma omp parallel for simd schedule(static)
    for (size_t i = 0; i < n; i++) r[i] = continuity[i] * scale[i];
    solve_pressure(pc, r, product, p);
    subtract_mean(pc, p);
  } else {
    solve_pressure(pc, continuity, product, p);
  }
  stokes_operator_apply_gradient(op, p, r);
  for (size_t a = 0; a < axes; a++) {
    float *ra = r + a * n;
#pragma omp parallel for simd schedule(static)
    for (size_t i = 0; i < n; i++)
      ra[i] = (scale ? x[a * n + i] / scale[i] : x[a * n + i]) - op->parabola[i] * ra[i];
    solve_velocity(pc, op->stencil->axes[a], ra, product, y + a * n);
  }
  stokes_operator_clear_plane(op, y);
}
