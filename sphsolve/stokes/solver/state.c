#include "sphsolve/stokes/solver/state.h"
#include "sphsolve/stokes/constants.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "common/threads.h"
#include "sphsolve/geometry/wall_shape.h"
#include "sphsolve/stokes/effects/stabilisation.h"

#define BASIS_MIN 6
#define BASIS_MAX 24
/* Minimum size where there is soil or a porosity above 0.5: a short basis costs more iterations
 * there, and in open felts a basis of 3 vectors does not converge. */
#define BASIS_OPEN 8
int stokes_solver_basis(double sites, double active, bool soil) {
  const double left = (MEMORY_GOAL - SOLVER_SITE_BYTES) * sites / active - ACTIVE_BYTES;
  const bool open = soil || active > 0.5 * sites;
  return (int)fmax(open ? BASIS_OPEN : BASIS_MIN, fmin(left / VECTOR_BYTES - 1.0, BASIS_MAX));
}

double stokes_solver_bytes(double sites, double active, bool soil) {
  const double more = soil ? SOIL_SITE_BYTES * sites + SOIL_ACTIVE_BYTES * active : 0.0;
  return SOLVER_SITE_BYTES * sites + more +
         (ACTIVE_BYTES + VECTOR_BYTES * (1.0 + stokes_solver_basis(sites, active, soil))) * active;
}

/* Fewest active sites per thread. */
#define SITES_PER_THREAD_MIN 4000

/* Scales the momentum and continuity rows of a residual by the weights of the soil (solver/soil.h,
 * row_scale). */
static void scale_rows(const struct stokes_operator *op, float *y) {
  const size_t n = op->n, axes = (size_t)op->stencil->axis_count;
  if (op->soil == NULL) return;
  const float *weight = op->soil->row_scale;
#pragma omp parallel for simd schedule(static)
  for (size_t i = 0; i < n; i++) {
    for (size_t a = 0; a < axes; a++) y[a * n + i] *= weight[i];
    y[axes * n + i] /= weight[i];
  }
}

static void apply(void *system, const float *x, float *y) {
  struct stokes_solver *s = system;
  stokes_operator_apply(&s->operator, x, y);
  stokes_operator_clear_plane(&s->operator, y);
  scale_rows(&s->operator, y);
}

static void precondition(void *system, const float *x, float *work, float *y) {
  struct stokes_solver *s = system;
  stokes_preconditioner_apply(&s->preconditioner, x, work, y);
}

/* Adjoint correction of the flux along the force for the residual (r_m, r_c): v.(r_m / D) - p.r_c.
 * The system is nearly self-adjoint once the momentum rows are divided by D and continuity is
 * negated, and the flux along the force is the functional that belongs to its right-hand side. The
 * error of the corrected flux is therefore of second order in the error of the solution (Pierce,
 * Giles 2000, SIAM Review 42). At pore sites beside soil, D contains the slip at the soil surface;
 * v is the better adjoint where that slip changes: without `divide` only the rows of soil are
 * divided by D. */
static double adjoint_correction(const struct stokes_solver *s, bool divide) {
  const size_t n = s->grid.active, axes = (size_t)s->stencil.axis_count;
  const struct stokes_grid *grid = &s->grid;
  const float *weight = s->operator.soil ? s->operator.soil->row_scale : NULL;
  double sum = 0.0;
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    double row_sum = 0.0;
    for (size_t i = grid->row_start[row]; i < grid->row_start[row + 1]; i++) {
      double momentum = 0.0;
      for (size_t a = 0; a < axes; a++)
        momentum += s->x[a * n + i] * (double)s->residual[a * n + i];
      double continuity = (double)s->residual[axes * n + i];
      if (weight) momentum /= (double)weight[i], continuity *= (double)weight[i];
      if (divide || (s->operator.soil && s->operator.soil->relative[i]<1.0f))
        momentum /= (double)s->operator.parabola[i];
      row_sum += momentum - s->x[axes * n + i] * continuity;
    }
    sum += stokes_grid_weight(grid, row) * row_sum;
  }
  return ranks_sum(sum);
}

/* Computes the residual in double precision. `at_rest`: x is 0. */
static void find_residual(struct stokes_solver *s, bool at_rest) {
  /* Work space: the second vector of the basis, from an address aligned for doubles. */
  const size_t begin = s->krylov.length + s->krylov.length % 2;
  double *component = (double *)(void *)(s->krylov.basis + begin);
  if (at_rest && s->operator.soil == NULL)
    stokes_operator_right_side(&s->operator, s->force, s->residual);
  else
    stokes_operator_residual(&s->operator, s->force, s->x, component, s->residual);
  stokes_operator_clear_plane(&s->operator, s->residual);
  scale_rows(&s->operator, s->residual);
  s->exact = true;
}

void stokes_solver_measure(struct stokes_solver *s, bool recompute) {
  if (recompute) find_residual(s, false);
  const size_t n = s->grid.active, axes = (size_t)s->stencil.axis_count;
  const struct stokes_operator *op = &s->operator;
  double sums[2] = {0.0}, flux[3], moved = 0.0, length = 0.0;
  /* the Krylov vectors behind the residual are free between rounds */
  float *p = s->krylov.work, *p_gradient = s->krylov.basis + s->krylov.length;
  for (size_t i = 0; i < n; i++) p[i] = (float)s->x[axes * n + i];
  stokes_operator_apply_gradient(&s->operator, p, p_gradient);
  stokes_operator_flux(&s->operator, s->force, s->x, p_gradient, flux);
  /* In steady flow the work of force and walls is dissipated: its mean equals that of |grad
   * v|^2. */
  for (size_t a = 0; a < axes; a++)
    for (size_t i = 0; i < n; i++) {
      double force = s->force[s->stencil.axes[a]];
      if (op->drag) force += (double)op->drag[a * n + i];
      sums[0] += fabs(force * s->x[a * n + i]);
    }
  const float *continuity = s->residual + axes * n;
  for (size_t i = 0; i < n; i++) {
    double open = (double)continuity[i];
    if (op->soil) open *= (double)op->soil->row_scale[i];
    sums[1] += open * open;
  }
  ranks_sum_all(sums, 2);
  s->divergence = sums[0] > 0.0 ? sqrt(sums[1] / sums[0]) : INFINITY;
  const double more = s->walls_move ? 0.0 : adjoint_correction(s, true);
  for (int a = 0; a < 3; a++) {
    const double mean = (flux[a] + more * s->force[a]) / s->bulk_count;
    moved = hypot(moved, mean - s->mean[a]);
    length = hypot(length, mean);
    s->mean[a] = mean;
  }
  s->change = length > 0.0 ? moved / length : INFINITY;
  const double norm = stokes_krylov_norm(&s->krylov, s->residual);
  if (s->residual_start == 0.0) s->residual_start = norm;
  s->residual_before = s->residual_now;
  s->residual_now = norm / s->residual_start;
}

/* Power of force and pressure, e = v . (f - G p), at an active site; raw: G p before correction. */
static double power_at(const struct stokes_solver *s, const float *raw, size_t i) {
  const size_t n = s->grid.active, axes = (size_t)s->stencil.axis_count;
  float gradient[3] = {0.0F};
  double power = 0.0;
  stokes_correct(&s->operator, i, raw, n, gradient);
  for (size_t a = 0; a < axes; a++)
    power += s->x[a * n + i] * (s->force[s->stencil.axes[a]] - (double)gradient[a]);
  return power;
}

/* Axis along which the force is largest. */
static int main_axis(const struct stokes_solver *s) {
  int axis = 0;
  for (int a = 1; a < 3; a++)
    if (fabs(s->force[a]) > fabs(s->force[axis])) axis = a;
  return axis;
}

/* Uncertainty of the position of the wall nearest to a site, in half spacings: within a spacing a
 * wall of curvature K is taken for a plane, and is off by h^2 K / 2, at an edge by h / 2. */
static double position_error(const struct stokes_solver *s, size_t row, size_t i) {
  const size_t at[3] = {i, row % s->grid.size[1], row / s->grid.size[1]};
  return fmin(1.0, wall_curvature(s->operator.lattice, at) * s->stencil.unit);
}

enum status stokes_solver_find_dissipating(struct stokes_solver *s, double least) {
  enum status status = STATUS_OK;
  const struct stokes_grid *grid = &s->grid;
  const size_t n = grid->active, axes = (size_t)s->stencil.axis_count;
  const int axis = main_axis(s);
  const size_t planes = grid->size[axis];
  float *p = s->krylov.work, *raw = s->krylov.basis + s->krylov.length;
  double *sums = NULL, total = 0.0, weighted = 0.0; /* of e and of (e c)^2 in each plane */
  TRY(memory_allocate(&sums, 2 * planes, sizeof *sums, "planes across the flow"));
  for (size_t i = 0; i < n; i++) p[i] = (float)s->x[axes * n + i];
  stokes_operator_apply_gradient(&s->operator, p, raw);
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    if (stokes_grid_is_y_image(grid, row)) continue;
    const double weight = stokes_grid_weight(grid, row);
    size_t at = grid->row_start[row];
    for (size_t i = 0; i < grid->size[0]; i++) {
      if (!stokes_grid_is_active(grid, row, i)) continue;
      const size_t plane = axis == 0 ? i : axis == 1 ? row % grid->size[1] : row / grid->size[1];
      const double power = power_at(s, raw, at++);
      const double off = power * fmax(least, position_error(s, row, i));
      sums[2 * plane] += weight * power;
      sums[2 * plane + 1] += weight * off * off;
    }
  }
  ranks_sum_all(sums, 2 * planes);
  for (size_t k = 0; k < planes; k++) {
    const double e = fmax(sums[2 * k], 0.0);
    total += e;
    if (e > 0.0) weighted += e * (e * e / sums[2 * k + 1]);
  }
  s->dissipating = total > 0.0 ? weighted / total : 0.0;
cleanup:
  memory_free(&sums);
  return status;
}

/* Sets the units of acceleration and velocity from the driving force and the fastest wall. */
static enum status set_units(struct stokes_solver *s, const struct scene *scene, double nu,
                             const double driving[3]) {
  double wall = 0.0;
  for (size_t r = 0; scene && r < scene->region_count; r++)
    if (scene->regions[r].type == REGION_WALL)
      for (int a = 0; a < 3; a++) wall = fmax(wall, fabs(scene->regions[r].velocity[a]));
  const double unit = s->stencil.unit;
  const double force =
      sqrt(driving[0] * driving[0] + driving[1] * driving[1] + driving[2] * driving[2]);
  s->acceleration = fmax(force, wall * nu / (unit * unit));
  if (!(s->acceleration > 0.0))
    return FAIL(STATUS_INPUT, "force: nothing drives the flow; give gravity, body_acceleration, "
                              "pressure_gradient or a wall that moves");
  s->velocity_unit = s->acceleration * unit * unit / nu;
  s->walls_move = wall > 0.0;
  for (int a = 0; a < 3; a++) s->force[a] = driving[a] / s->acceleration;
  return STATUS_OK;
}

static enum status build(const struct lattice *lattice, const struct scene *scene, double support,
                         enum wall_scheme wall, double nu, const double driving[3], bool half,
                         struct stokes_solver *s) {
  enum status status = STATUS_OK;
  const int threads = omp_get_max_threads();
  memset(s, 0, sizeof *s);
  s->bulk_count = lattice->bulk_count;
  if (!lattice_holds_fluid(lattice))
    TRY_FAIL(STATUS_INPUT, "scene: no wall holds the fluid back, so a steady flow does not exist; "
                           "add a wall, or choose method wcsph and an end_time");
  TRY(stokes_stencil_build(lattice->dimensions, lattice->spacing,
                           scene ? scene->stokes.kernel : KERNEL_QUINTIC, support, &s->stencil));
  TRY(set_units(s, scene, nu, driving));
  TRY(stokes_grid_build(lattice, driving, s->walls_move, &s->grid));
  int reach = 0;
  for (int o = 0; o < s->stencil.offset_count; o++)
    if (s->stencil.offsets[o].step[2] > reach) reach = s->stencil.offsets[o].step[2];
  const size_t active = s->grid.active_all;
  if (half && !s->walls_move) stokes_grid_mirror(&s->grid, lattice, driving, reach);
  TRY(stokes_grid_distribute(&s->grid, reach));
  if (active == 0) return STATUS_OK;
  const size_t length = (size_t)(lattice->dimensions + 1) * s->grid.active;
  omp_set_num_threads(threads_for((double)s->grid.active, SITES_PER_THREAD_MIN, threads));
  TRY(stokes_operator_build(&s->stencil, &s->grid, lattice, scene, wall, STOKES_STABILISATION,
                            s->velocity_unit, s->force, &s->operator));
  TRY(stokes_preconditioner_build(&s->operator, & s->preconditioner));
  TRY(interrupt_look());
  TRY(memory_allocate(&s->x, length, sizeof *s->x, "velocity and pressure"));
  const int basis =
      stokes_solver_basis((double)lattice->count, (double)active, s->operator.soil != NULL);
  TRY(stokes_krylov_build(length, basis, &s->krylov));
  s->residual = s->krylov.basis;
  s->krylov.system = s;
  s->krylov.apply = apply;
  s->krylov.precondition = precondition;
  s->residual_now = INFINITY;
  TRY(interrupt_look());
  find_residual(s, true);
  TRY(interrupt_look());
  stokes_solver_measure(s, false);
cleanup:
  omp_set_num_threads(threads);
  if (status != STATUS_OK) stokes_solver_free(s);
  return status;
}

enum status stokes_solver_build(const struct lattice *lattice, const struct scene *scene,
                                double support, enum wall_scheme wall, double nu,
                                const double driving[3], struct stokes_solver *s) {
  return build(lattice, scene, support, wall, nu, driving, false, s);
}

enum status stokes_solver_build_half(const struct lattice *lattice, const struct scene *scene,
                                     double support, enum wall_scheme wall, double nu,
                                     const double driving[3], struct stokes_solver *s) {
  return build(lattice, scene, support, wall, nu, driving, true, s);
}

enum status stokes_solver_set_soil(struct stokes_solver *s, const struct lattice *lattice) {
  const int threads = omp_get_max_threads();
  const struct stokes_operator was = s->operator;
  omp_set_num_threads(was.threads);
  stokes_operator_free(&s->operator);
  const enum status status =
      stokes_operator_build(was.stencil, was.grid, lattice, was.scene, was.wall, was.stabilisation,
                            was.velocity_unit, was.force, &s->operator);
  omp_set_num_threads(threads);
  return status;
}

double stokes_solver_functional(struct stokes_solver *s) {
  double along = 0.0;
  stokes_solver_restart(s);
  for (int a = 0; a < 3; a++) along += s->mean[a] * s->force[a];
  return along + (adjoint_correction(s, false) - adjoint_correction(s, true)) / s->bulk_count;
}

void stokes_solver_free(struct stokes_solver *s) {
  stokes_stencil_free(&s->stencil);
  stokes_grid_free(&s->grid);
  stokes_operator_free(&s->operator);
  stokes_preconditioner_free(&s->preconditioner);
  stokes_krylov_free(&s->krylov);
  memory_free(&s->x);
}

void stokes_solver_restart(struct stokes_solver *s) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(s->operator.threads);
  stokes_solver_measure(s, true);
  omp_set_num_threads(threads);
}
