#include "sphsolve/solute/closure.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/solute/constants.h"

enum status solute_closure_build(const struct solute_flow *flow, int coarsenings,
                                 struct solute_closure *c) {
  enum status status = STATUS_OK;
  *c = (struct solute_closure){.axis = {0, 1, 2},
                               .unit = flow->spacing[0],
                               .speed = flow->speed,
                               .direction = {0, 0, 1},
                               .dimensions = flow->dimensions};
  int last = 2;
  for (int a = 0; a < 3; a++)
    if (fabs(flow->mean_velocity[a]) > fabs(flow->mean_velocity[last])) last = a;
  c->axis[last] = 2, c->axis[2] = last;
  for (int a = 0; a < 3 && flow->speed > 0; a++) {
    c->mean[a] = flow->mean_velocity[c->axis[a]] / flow->speed;
    c->direction[a] = flow->mean_velocity[a] / flow->speed;
  }
  TRY(solute_solver_build(flow, c->axis, flow->mean_velocity[last] < 0, coarsenings, &c->solver));
  c->spacing = pow(2, coarsenings);
  const size_t size = c->solver.cells[0].size;
  TRY(memory_allocate(&c->source, size, sizeof(double), "source of the closure problem"));
  for (int a = 0; a < 3; a++)
    if (c->solver.cells[0].n[a] > 1)
      TRY(memory_allocate(&c->b[a], size, sizeof(double), "closure variable"));
cleanup:
  if (status != STATUS_OK) solute_closure_free(c);
  return status;
}

void solute_closure_free(struct solute_closure *c) {
  solute_solver_free(&c->solver);
  memory_free(&c->source);
  for (int a = 0; a < 3; a++) memory_free(&c->b[a]);
}

/* Source: s <u_a> V minus what leaves a cell if b is the coordinate x_a itself, relative to the
 * cell's centre: conduction and advection through the faces across a. */
static void set_source(struct solute_closure *c, int a, double s) {
  const struct solute_cells *cells = &c->solver.cells[0];
#pragma omp parallel for schedule(static)
  for (int k = 0; k < cells->n[2]; k++)
    for (int j = 0; j < cells->n[1]; j++)
      for (int i = 0; i < cells->n[0]; i++) {
        const size_t at = solute_cells_at(cells, i, j, k), up = at + cells->stride[a];
        const float *g = cells->conductance[a], *u = cells->flux[a];
        const int x[3] = {i, j, k}, n = cells->n[a];
        double value = (double)g[up] * solute_cells_apart(cells, a, (x[a] + 1) % n) -
                       (double)g[at] * solute_cells_apart(cells, a, x[a]);
        if (s > 0)
          value += s * (c->mean[a] * (double)cells->volume[at] -
                        0.5 * cells->width[a][x[a]] * ((double)u[up] + (double)u[at]));
        c->source[at] = value;
      }
}

/* Sum over faces of G (difference of phi_p) (difference of phi_q), over the volume. */
static double product(const struct solute_closure *c, int p, int q) {
  const struct solute_cells *cells = &c->solver.cells[0];
  double sum = 0, volume = 0;
  for (int k = 0; k < cells->n[2]; k++)
    for (int j = 0; j < cells->n[1]; j++)
      for (int i = 0; i < cells->n[0]; i++) {
        const size_t at = solute_cells_at(cells, i, j, k);
        volume += (double)cells->volume[at];
        for (int a = 0; a < 3; a++) {
          const double g = (double)cells->conductance[a][at];
          const size_t low = at - cells->stride[a];
          if (!(g > 0)) continue;
          const int x[3] = {i, j, k};
          const double apart = solute_cells_apart(cells, a, x[a]);
          sum += g * (c->b[p][at] - c->b[p][low] + (a == p ? apart : 0)) *
                 (c->b[q][at] - c->b[q][low] + (a == q ? apart : 0));
        }
      }
  return sum / volume;
}

void solute_dispersion_parts(const double n[3], int dimensions, struct solute_dispersion *d) {
  double along = 0, trace = 0;
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      along += n[p] * d->tensor[p][q] * n[q];
      if (p == q && !(dimensions == 2 && p == 1)) trace += d->tensor[p][q];
    }
  d->longitudinal = along;
  d->transverse = (trace - along) / (dimensions - 1);
}

/* Solves this rank's directions. Each rank has the whole flow; the directions are divided among
 * them. */
static enum status solve_directions(struct solute_closure *c, double s, double tolerance,
                                    struct solute_dispersion *d) {
  enum status status = STATUS_OK;
  const size_t size = c->solver.cells[0].size;
  for (int a = 0; a < 3; a++) {
    int iterations;
    double reached;
    if (c->b[a] == NULL) continue;
    if (a % ranks_count() != ranks_own()) {
      memset(c->b[a], 0, size * sizeof *c->b[a]);
      continue;
    }
    set_source(c, a, s);
    TRY(solute_solver_solve(&c->solver, c->source, tolerance, fmax(tolerance, RESIDUAL_STALLED),
                            c->b[a], &iterations, &reached));
    solute_cells_wrap_exact(&c->solver.cells[0], c->b[a]);
    d->iterations += iterations;
    d->residual = fmax(d->residual, reached);
  }
cleanup:
  return status;
}

enum status solute_closure_solve(struct solute_closure *c, double diffusion, double tolerance,
                                 struct solute_dispersion *d) {
  enum status status = STATUS_OK;
  const double s = c->speed > 0 && isfinite(diffusion) ? c->speed * c->unit / diffusion : 0;
  *d = (struct solute_dispersion){0};
  solute_solver_set(&c->solver, s);
  TRY(ranks_agree(solve_directions(c, s, tolerance, d)));
  for (int a = 0; a < 3; a++)
    if (c->b[a] != NULL) ranks_sum_all(c->b[a], c->solver.cells[0].size);
  d->iterations = (int)ranks_sum(d->iterations);
  d->residual = ranks_max(d->residual);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++) {
      double *entry = &d->tensor[c->axis[p]][c->axis[q]];
      if (c->b[p] == NULL || c->b[q] == NULL)
        *entry = p == q ? 1 : 0; /* one cell along this axis: unobstructed */
      else if (q < p)
        *entry = d->tensor[c->axis[q]][c->axis[p]];
      else
        *entry = product(c, p, q);
    }
  solute_dispersion_parts(c->direction, c->dimensions, d);
cleanup:
  return status;
}
