#include "sphsolve/methods/stokes_solver.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* Stabilisation in units of spacing^2 / nu: its error falls as spacing^2. */
#define TAU 0.02
#define BASIS 30
#define ROUND_REDUCTION 1e-3

static void apply(void *system, const float *x, float *y)
{
  struct stokes_solver *s = system;
  stokes_operator_apply(&s->operator, x, y);
}

static void precondition(void *system, const float *x, float *y)
{
  struct stokes_solver *s = system;
  const size_t n = s->grid.active, velocities = (size_t)s->stencil.axis_count * n;
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < velocities; i++) y[i] = x[i] / s->operator.diagonal[i % n];
  memcpy(y + velocities, x + velocities, n * sizeof *y);
}

static void measure(struct stokes_solver *s)
{
  const size_t n = s->grid.active, axes = (size_t)s->stencil.axis_count;
  double work = 0.0, square = 0.0, before = 0.0, now = 0.0;
  stokes_operator_residual(&s->operator, s->force, NULL, s->x, s->residual);
  for (int a = 0; a < 3; a++) before += s->mean[a] * s->force[a];
  memset(s->mean, 0, sizeof s->mean);
  for (size_t a = 0; a < axes; a++) {
    const double *v = s->x + a * n;
    double sum = 0.0;
    for (size_t i = 0; i < n; i++) sum += v[i];
    s->mean[s->stencil.axes[a]] = sum / (double)s->bulk_count;
    work += fabs(s->force[s->stencil.axes[a]] * sum);
  }
  for (int a = 0; a < 3; a++) now += s->mean[a] * s->force[a];
  const float *continuity = s->residual + axes * n;
  for (size_t i = 0; i < n; i++) square += (double)continuity[i] * (double)continuity[i];
  const double norm = krylov_norm(&s->krylov, s->residual);
  if (s->residual_start == 0.0) s->residual_start = norm;
  s->residual_now = norm / s->residual_start;
  /* In steady flow the work of the force is dissipated: its mean is the mean of |grad v|^2. */
  s->divergence = work > 0.0 ? sqrt(square / work) : INFINITY;
  s->change = now != 0.0 ? fabs(now - before) / fabs(now) : INFINITY;
}

enum status stokes_solver_build(const struct lattice *lattice, double support,
                                enum wall_scheme wall, const double driving[3],
                                struct stokes_solver *s)
{
  enum status status = STATUS_OK;
  memset(s, 0, sizeof *s);
  s->bulk_count = lattice->bulk_count;
  double strength = 0.0;
  for (int a = 0; a < 3; a++) strength = hypot(strength, driving[a]);
  if (!(strength > 0.0))
    TRY_FAIL(STATUS_INPUT, "force: nothing drives the flow; give gravity, body_acceleration or "
                           "pressure_gradient");
  for (int a = 0; a < 3; a++) s->force[a] = driving[a] / strength;
  if (lattice->fluid_count + lattice->wall_count < lattice->count)
    TRY_FAIL(STATUS_INPUT, "regions: method stokes knows no free surface and %zu sites are empty; "
                           "fill them with water or wall, or choose method isph",
             lattice->count - lattice->fluid_count - lattice->wall_count);
  if (lattice->fluid_count == lattice->count)
    TRY_FAIL(STATUS_INPUT, "scene: no wall holds the fluid back, so a steady flow does not exist; "
                           "add a wall, or choose method wcsph and an end_time");
  TRY(stokes_stencil_build(lattice->dimensions, lattice->spacing, support, &s->stencil));
  TRY(stokes_grid_build(lattice, driving, 0, &s->grid));
  if (s->grid.active == 0) return STATUS_OK;
  const size_t length = (size_t)(lattice->dimensions + 1) * s->grid.active;
  TRY(stokes_operator_build(&s->stencil, &s->grid, lattice, wall, TAU, &s->operator));
  TRY(krylov_build(length, BASIS, &s->krylov));
  s->krylov.system = s;
  s->krylov.apply = apply;
  s->krylov.precondition = precondition;
  TRY(memory_allocate(&s->x, length, sizeof *s->x, "velocity and pressure"));
  TRY(memory_allocate(&s->residual, length, sizeof *s->residual, "residual"));
  measure(s);
  return STATUS_OK;
cleanup:
  stokes_solver_free(s);
  return status;
}

void stokes_solver_free(struct stokes_solver *s)
{
  stokes_grid_free(&s->grid);
  stokes_operator_free(&s->operator);
  krylov_free(&s->krylov);
  memory_free(&s->x);
  memory_free(&s->residual);
}

void stokes_solver_round(struct stokes_solver *s)
{
  double reached;
  s->iterations += krylov_correct(&s->krylov, s->residual, ROUND_REDUCTION, s->x, &reached);
  measure(s);
}

bool stokes_solver_converged(const struct stokes_solver *s, double tolerance)
{
  return s->residual_now <= tolerance && s->divergence <= 1e-4 && s->change <= 1e-4;
}

enum status stokes_solver_run(struct stokes_solver *s, double tolerance)
{
  double best = INFINITY;
  for (int stalled = 0; stalled < 10;) {
    stokes_solver_round(s);
    if (stokes_solver_converged(s, tolerance)) return STATUS_OK;
    stalled = s->residual_now < 0.9 * best ? 0 : stalled + 1;
    best = fmin(best, s->residual_now);
  }
  return FAIL(STATUS_NUMERIC,
              "stokes: no progress after %ld iterations at a residual of %.1e (wanted %.1e); "
              "a larger stokes.tolerance accepts it", s->iterations, s->residual_now, tolerance);
}
