#include "sphsolve/stokes/solver.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/stokes/effects/stabilisation.h"

#define ROUND_REDUCTION 1e-2
/* The basis takes what MEMORY_GOAL (bytes per site) leaves; a short one costs few iterations more.
 * SITE_BYTES: lattice 5, unpacked fields 16, coarse levels 10. ACTIVE_BYTES: operator 52, kappa 4,
 * solution 32, Krylov work vector 16; and 16 for every vector of the basis, the first of which is
 * the residual. */
#define MEMORY_GOAL 103.0
#define SITE_BYTES 31.0
#define ACTIVE_BYTES 104.0
#define BASIS_MIN 3
#define BASIS_MAX 24

int stokes_solver_basis(double sites, double active) {
  const double left = (MEMORY_GOAL - SITE_BYTES) * sites / active - ACTIVE_BYTES;
  return (int)fmax(BASIS_MIN, fmin(left / 16.0 - 1.0, BASIS_MAX));
}

double stokes_solver_bytes(double sites, double active) {
  return SITE_BYTES * sites +
         (ACTIVE_BYTES + 16.0 * (1.0 + stokes_solver_basis(sites, active))) * active;
}

/* Threads that so many sites keep busy; waiting for more costs longer than they help. */
#define SITES_A_THREAD 4000

static int threads_for(size_t active) {
  const size_t most = (size_t)omp_get_max_threads(), wanted = 1 + active / SITES_A_THREAD;
  return (int)(wanted < most ? wanted : most);
}

static void apply(void *system, const float *x, float *y) {
  struct stokes_solver *s = system;
  stokes_operator_apply(&s->operator, x, y);
}

static void precondition(void *system, const float *x, float *work, float *y) {
  struct stokes_solver *s = system;
  stokes_preconditioner_apply(&s->preconditioner, x, work, y);
}

static void measure(struct stokes_solver *s) {
  const size_t n = s->grid.active, axes = (size_t)s->stencil.axis_count;
  const struct stokes_operator *op = &s->operator;
  double work = 0.0, square = 0.0, flux[3], moved = 0.0, length = 0.0;
  /* the Krylov vectors are free between rounds */
  float *p = s->krylov.work, *p_gradient = s->krylov.basis;
  for (size_t i = 0; i < n; i++) p[i] = (float)s->x[axes * n + i];
  stokes_operator_apply_gradient(&s->operator, p, p_gradient);
  stokes_operator_flux(&s->operator, s->force, s->x, p_gradient, flux);
  for (int a = 0; a < 3; a++) {
    const double mean = flux[a] / s->bulk_count;
    moved = hypot(moved, mean - s->mean[a]);
    length = hypot(length, mean);
    s->mean[a] = mean;
  }
  s->change = length > 0.0 ? moved / length : INFINITY;
  /* In steady flow the work of force and walls is dissipated: its mean is that of |grad v|^2. */
  for (size_t a = 0; a < axes; a++)
    for (size_t i = 0; i < n; i++) {
      double force = s->force[s->stencil.axes[a]];
      if (op->drag) force += (double)op->drag[a * n + i];
      work += fabs(force * s->x[a * n + i]);
    }
  /* In the second vector of the basis, from where doubles may begin. */
  const size_t begin = s->krylov.length + s->krylov.length % 2;
  double *component = (double *)(void *)(s->krylov.basis + begin);
  stokes_operator_residual(&s->operator, s->force, s->x, component, s->residual);
  const float *continuity = s->residual + axes * n;
  for (size_t i = 0; i < n; i++) square += (double)continuity[i] * (double)continuity[i];
  double sums[2] = {work, square};
  ranks_sum_all(sums, 2);
  work = sums[0], square = sums[1];
  s->divergence = work > 0.0 ? sqrt(square / work) : INFINITY;
  const double norm = stokes_krylov_norm(&s->krylov, s->residual);
  if (s->residual_start == 0.0) s->residual_start = norm;
  s->residual_now = norm / s->residual_start;
}

/* What drives the flow, and how fast: the force, or the fastest wall. */
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

enum status stokes_solver_build(const struct lattice *lattice, const struct scene *scene,
                                double support, enum wall_scheme wall, double nu,
                                const double driving[3], struct stokes_solver *s) {
  enum status status = STATUS_OK;
  const int threads = omp_get_max_threads();
  memset(s, 0, sizeof *s);
  s->bulk_count = lattice->bulk_count;
  if (lattice->fluid_count == lattice->count)
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
  TRY(stokes_grid_share(&s->grid, reach));
  if (active == 0) return STATUS_OK;
  const size_t length = (size_t)(lattice->dimensions + 1) * s->grid.active;
  omp_set_num_threads(threads_for(s->grid.active));
  TRY(stokes_operator_build(&s->stencil, &s->grid, lattice, scene, wall, STOKES_TAU,
                            s->velocity_unit, &s->operator));
  TRY(stokes_preconditioner_build(&s->operator, & s->preconditioner));
  TRY(memory_allocate(&s->x, length, sizeof *s->x, "velocity and pressure"));
  TRY(stokes_krylov_build(length, stokes_solver_basis((double)lattice->count, (double)active),
                          &s->krylov));
  s->residual = s->krylov.basis;
  s->krylov.system = s;
  s->krylov.apply = apply;
  s->krylov.precondition = precondition;
  measure(s);
cleanup:
  omp_set_num_threads(threads);
  if (status != STATUS_OK) stokes_solver_free(s);
  return status;
}

void stokes_solver_free(struct stokes_solver *s) {
  stokes_grid_free(&s->grid);
  stokes_operator_free(&s->operator);
  stokes_preconditioner_free(&s->preconditioner);
  stokes_krylov_free(&s->krylov);
  memory_free(&s->x);
}

void stokes_solver_measure(struct stokes_solver *s) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(s->operator.threads);
  measure(s);
  omp_set_num_threads(threads);
}

void stokes_solver_round(struct stokes_solver *s) {
  double shrunk = 1.0, reached;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(s->operator.threads);
  for (int cycle = 0; cycle < 20 && shrunk > ROUND_REDUCTION; cycle++) {
    s->iterations += stokes_krylov_correct(&s->krylov, ROUND_REDUCTION / shrunk, s->x, &reached);
    shrunk *= reached;
  }
  measure(s);
  omp_set_num_threads(threads);
}

bool stokes_solver_converged(const struct stokes_solver *s, double tolerance) {
  return s->residual_now <= tolerance && s->divergence <= 1e-4 && s->change <= 1e-4;
}

enum status stokes_solver_run(struct stokes_solver *s, double tolerance) {
  double best = INFINITY;
  if (s->grid.active_all == 0) return STATUS_OK;
  for (int stalled = 0; stalled < 10;) {
    stokes_solver_round(s);
    if (stokes_solver_converged(s, tolerance)) return STATUS_OK;
    stalled = s->residual_now < 0.9 * best ? 0 : stalled + 1;
    best = fmin(best, s->residual_now);
  }
  return FAIL(STATUS_NUMERIC,
              "stokes: no progress after %ld iterations at a residual of %.1e (wanted %.1e); "
              "a larger stokes.tolerance accepts it",
              s->iterations, s->residual_now, tolerance);
}
