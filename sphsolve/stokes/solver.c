#include "sphsolve/stokes/solver.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/stokes/effects/stabilisation.h"

#define ROUND_REDUCTION 0.25
/* The basis takes what MEMORY_GOAL (bytes per site) leaves; a short one costs few iterations more.
 * SITE_BYTES: lattice 5, unpacked fields 16, coarse levels 10. ACTIVE_BYTES: operator 52, kappa 4,
 * solution 32, Krylov work vector 16, edges 4; and 16 for every vector of the basis, the first of
 * which is the residual. */
#define MEMORY_GOAL 125.0
#define SITE_BYTES 31.0
#define ACTIVE_BYTES 108.0
#define BASIS_MIN 3
#define BASIS_MAX 24
/* Of a flow that is solved but for rounding. */
#define RESIDUAL_EXACT 1e-6

/* Where neither the residual nor the velocity is said to be good enough. */
#define RESIDUAL_DEFAULT 1e-6

struct stokes_goal stokes_goal_of(const struct scene *scene) {
  struct stokes_goal goal = {.residual = scene->stokes.tolerance, .mean = scene->steady_tolerance};
  if (isnan(goal.residual)) goal.residual = goal.mean > 0.0 ? 0.0 : RESIDUAL_DEFAULT;
  return goal;
}

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
  stokes_operator_clear_plane(&s->operator, y);
}

static void precondition(void *system, const float *x, float *work, float *y) {
  struct stokes_solver *s = system;
  stokes_preconditioner_apply(&s->preconditioner, x, work, y);
}

/* What the residual (r_m, r_c) adds to the flux along the force: v.(r_m / D) - p.r_c. The system is
 * nearly its own adjoint once the momentum rows are divided by D and continuity is negated, and the
 * flux along the force is the functional that belongs to its right-hand side, so that with this
 * the flux is wrong by the square of the solution's error (Pierce, Giles 2000, SIAM Review 42). */
static double adjoint_correction(const struct stokes_solver *s) {
  const size_t n = s->grid.active, axes = (size_t)s->stencil.axis_count;
  const struct stokes_grid *grid = &s->grid;
  double sum = 0.0;
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    double own = 0.0;
    for (size_t i = grid->row_start[row]; i < grid->row_start[row + 1]; i++) {
      double momentum = 0.0;
      for (size_t a = 0; a < axes; a++)
        momentum += s->x[a * n + i] * (double)s->residual[a * n + i];
      own += momentum / (double)s->operator.parabola[i] - s->x[axes * n + i] *(double)
                            s->residual[axes * n + i];
    }
    sum += stokes_grid_weight(grid, row) * own;
  }
  return ranks_sum(sum);
}

/* The residual in double precision, and the divergence that is left of it. */
static void find_residual(struct stokes_solver *s) {
  /* In the second vector of the basis, from where doubles may begin. */
  const size_t begin = s->krylov.length + s->krylov.length % 2;
  double *component = (double *)(void *)(s->krylov.basis + begin);
  stokes_operator_residual(&s->operator, s->force, s->x, component, s->residual);
  stokes_operator_clear_plane(&s->operator, s->residual);
  s->exact = true;
}

/* Flux, divergence and residual of x; the residual vector stands already. */
static void measure(struct stokes_solver *s) {
  const size_t n = s->grid.active, axes = (size_t)s->stencil.axis_count;
  const struct stokes_operator *op = &s->operator;
  double sums[2] = {0.0}, flux[3], moved = 0.0, length = 0.0;
  /* the Krylov vectors behind the residual are free between rounds */
  float *p = s->krylov.work, *p_gradient = s->krylov.basis + s->krylov.length;
  for (size_t i = 0; i < n; i++) p[i] = (float)s->x[axes * n + i];
  stokes_operator_apply_gradient(&s->operator, p, p_gradient);
  stokes_operator_flux(&s->operator, s->force, s->x, p_gradient, flux);
  /* In steady flow the work of force and walls is dissipated: its mean is that of |grad v|^2. */
  for (size_t a = 0; a < axes; a++)
    for (size_t i = 0; i < n; i++) {
      double force = s->force[s->stencil.axes[a]];
      if (op->drag) force += (double)op->drag[a * n + i];
      sums[0] += fabs(force * s->x[a * n + i]);
    }
  const float *continuity = s->residual + axes * n;
  for (size_t i = 0; i < n; i++) sums[1] += (double)continuity[i] * (double)continuity[i];
  ranks_sum_all(sums, 2);
  s->divergence = sums[0] > 0.0 ? sqrt(sums[1] / sums[0]) : INFINITY;
  const double more = s->walls_move ? 0.0 : adjoint_correction(s);
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

/* The flux is wrong by the square of the solution's error, hence of the residual: with the share q
 * that a round left of that square, the flux has moved by (1 - q) of its error before, and q / (1 -
 * q) of this step is still to come. Where walls move, without the correction, by the residual
 * itself. */
#define MEAN_SAFETY 2.0
double stokes_solver_mean_error(const struct stokes_solver *s) {
  const double left = s->residual_now / s->residual_before;
  const double q = s->walls_move ? left : left * left;
  if (s->residual_now <= RESIDUAL_EXACT) return fmin(s->change, RESIDUAL_EXACT);
  return s->change < 1.0 && q < 1.0 ? MEAN_SAFETY * s->change * q / (1.0 - q) : INFINITY;
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

static enum status build(const struct lattice *lattice, const struct scene *scene, double support,
                         enum wall_scheme wall, double nu, const double driving[3], bool half,
                         struct stokes_solver *s) {
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
  if (half && !s->walls_move) stokes_grid_mirror(&s->grid, lattice, driving, reach);
  TRY(stokes_grid_distribute(&s->grid, reach));
  if (active == 0) return STATUS_OK;
  const size_t length = (size_t)(lattice->dimensions + 1) * s->grid.active;
  omp_set_num_threads(threads_for(s->grid.active));
  TRY(stokes_operator_build(&s->stencil, &s->grid, lattice, scene, wall, STOKES_STABILISATION,
                            s->velocity_unit, &s->operator));
  TRY(stokes_preconditioner_build(&s->operator, & s->preconditioner));
  TRY(memory_allocate(&s->x, length, sizeof *s->x, "velocity and pressure"));
  TRY(stokes_krylov_build(length, stokes_solver_basis((double)lattice->count, (double)active),
                          &s->krylov));
  s->residual = s->krylov.basis;
  s->krylov.system = s;
  s->krylov.apply = apply;
  s->krylov.precondition = precondition;
  s->residual_now = INFINITY;
  find_residual(s);
  measure(s);
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

void stokes_solver_free(struct stokes_solver *s) {
  stokes_grid_free(&s->grid);
  stokes_operator_free(&s->operator);
  stokes_preconditioner_free(&s->preconditioner);
  stokes_krylov_free(&s->krylov);
  memory_free(&s->x);
}

void stokes_solver_restart(struct stokes_solver *s) {
  const int threads = omp_get_max_threads();
  omp_set_num_threads(s->operator.threads);
  find_residual(s);
  measure(s);
  omp_set_num_threads(threads);
}

/* Below this share of the first residual the single precision of the Krylov vectors tells: the
 * residual is then found anew after each round. */
#define EXACT_BELOW 1e-4

bool stokes_solver_round(struct stokes_solver *s) {
  double reached;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(s->operator.threads);
  const int done = stokes_krylov_correct(&s->krylov, ROUND_REDUCTION, s->x, &reached);
  if (done > 0) {
    s->iterations += done;
    s->exact = false;
    /* The walls of Adami are no part of the operator, only of the residual. */
    if (s->operator.wall == WALL_ADAMI || reached * s->residual_now<EXACT_BELOW) find_residual(s);
    measure(s);
  }
  omp_set_num_threads(threads);
  return done > 0 || s->residual_now == 0.0;
}

bool stokes_solver_converged(struct stokes_solver *s, const struct stokes_goal *goal) {
  if (goal->residual > 0.0) {
    if (!(s->residual_now <= goal->residual && s->divergence <= 1e-4 && s->change <= 1e-4))
      return false;
    return s->exact;
  }
  return stokes_solver_mean_error(s) <= goal->mean;
}

enum status stokes_solver_run(struct stokes_solver *s, const struct stokes_goal *goal) {
  double best = INFINITY;
  if (s->grid.active_all == 0) return STATUS_OK;
  for (int stalled = 0; stalled < 10;) {
    if (!stokes_solver_round(s)) return FAIL(STATUS_INTERRUPTED, "interrupted");
    if (stokes_solver_converged(s, goal)) return STATUS_OK;
    stalled = s->residual_now < 0.9 * best ? 0 : stalled + 1;
    best = fmin(best, s->residual_now);
  }
  return FAIL(STATUS_NUMERIC,
              "stokes: no progress after %ld iterations at a residual of %.1e; a larger "
              "stokes.tolerance accepts it",
              s->iterations, s->residual_now);
}
