#include "sphsolve/solute/flow.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/flow_cells.h"
#include "sphsolve/solute/multigrid.h"

enum status solute_flow_allocate(const int n[3], const double spacing[3], struct solute_flow *f) {
  enum status status = STATUS_OK;
  size_t plane;
  *f = (struct solute_flow){.dimensions = n[1] == 1 ? 2 : 3, .viscosity = NAN, .density = NAN};
  for (int a = 0; a < 3; a++) f->n[a] = n[a], f->spacing[a] = spacing[a];
  if (!size_multiply((size_t)n[0], (size_t)n[1], &plane) ||
      !size_multiply(plane, (size_t)n[2], &f->count))
    return FAIL(STATUS_INPUT, "%d x %d x %d cells are more than can be counted", n[0], n[1], n[2]);
  TRY(memory_allocate(&f->distance, f->count, sizeof(float), "wall distances of the flow"));
  TRY(memory_allocate(&f->volume, f->count, sizeof(float), "volumes of the flow's cells"));
  for (int a = 0; a < 3; a++) {
    TRY(memory_allocate(&f->aperture[a], f->count, sizeof(float), "faces of the flow's cells"));
    TRY(memory_allocate(&f->velocity[a], f->count, sizeof(float), "fluxes of the flow"));
  }
cleanup:
  if (status != STATUS_OK) solute_flow_free(f);
  return status;
}

void solute_flow_free(struct solute_flow *f) {
  MEMORY_FREE(&f->distance, &f->volume);
  for (int a = 0; a < 3; a++) {
    MEMORY_FREE(&f->aperture[a], &f->velocity[a]);
  }
}

void solute_flow_measure(struct solute_flow *f) {
  const double cell = f->spacing[0] * f->spacing[1] * f->spacing[2];
  double volume = 0, sum[3] = {0}, surface = 0;
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const size_t at = solute_flow_at(f, i, j, k);
        const size_t up[3] = {solute_flow_at(f, i + 1, j, k), solute_flow_at(f, i, j + 1, k),
                              solute_flow_at(f, i, j, k + 1)};
        double wall = 0;
        volume += (double)f->volume[at];
        for (int a = 0; a < 3; a++) {
          sum[a] += (double)f->velocity[a][at];
          const double area =
              cell / f->spacing[a] * ((double)f->aperture[a][up[a]] - (double)f->aperture[a][at]);
          wall += area * area;
        }
        surface += sqrt(wall);
      }
  f->porosity = volume / (double)f->count;
  double square = 0;
  for (int a = 0; a < 3; a++) {
    f->mean_velocity[a] = volume > 0 ? sum[a] / volume : 0;
    square += f->mean_velocity[a] * f->mean_velocity[a];
  }
  f->speed = sqrt(square);
  f->grain_size = surface > 0 ? 6 * ((double)f->count - volume) * cell / surface : NAN;
}

static uint32_t root_of(uint32_t *parent, uint32_t at) {
  while (parent[at] != at) at = parent[at] = parent[parent[at]];
  return at;
}

/* Closes the cells of pores that no face connects to the flowing ones. Without flow, only pores of
 * less than a thousandth of the pore volume are closed. */
static enum status close_isolated(struct solute_flow *f) {
  enum status status = STATUS_OK;
  uint32_t *parent = NULL;
  double *volume = NULL, *sum = NULL;
  if (f->count >= UINT32_MAX)
    return FAIL(STATUS_INPUT, "a flow of more than %u points is too large", UINT32_MAX);
  TRY(memory_allocate(&parent, f->count, sizeof *parent, "connected pores"));
  for (size_t at = 0; at < f->count; at++) parent[at] = (uint32_t)at;
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const size_t at = solute_flow_at(f, i, j, k);
        const size_t low[3] = {solute_flow_at(f, i - 1, j, k), solute_flow_at(f, i, j - 1, k),
                               solute_flow_at(f, i, j, k - 1)};
        for (int a = 0; a < 3; a++) {
          if (!(f->aperture[a][at] > 0)) continue;
          const uint32_t p = root_of(parent, (uint32_t)at), q = root_of(parent, (uint32_t)low[a]);
          if (p < q)
            parent[q] = p;
          else
            parent[p] = q;
        }
      }
  TRY(memory_allocate(&volume, f->count, sizeof *volume, "volumes of pores"));
  TRY(memory_allocate(&sum, f->count, sizeof *sum, "fluxes of pores"));
  const double *u = f->mean_velocity;
  double pores = 0, closed = 0;
  for (size_t at = 0; at < f->count; at++) {
    const uint32_t root = root_of(parent, (uint32_t)at);
    pores += (double)f->volume[at];
    volume[root] += (double)f->volume[at];
    for (int a = 0; a < 3 && f->speed > 0; a++)
      sum[root] += (double)f->velocity[a][at] * u[a] / (f->speed * f->speed);
  }
  for (size_t at = 0; at < f->count; at++) {
    const uint32_t root = root_of(parent, (uint32_t)at);
    const bool stagnant = f->speed > 0 ? !(fabs(sum[root]) > STAGNANT_FRACTION * volume[root])
                                       : !(volume[root] > STAGNANT_FRACTION * pores);
    if (!stagnant) continue;
    closed += (double)f->volume[at];
    f->volume[at] = 0;
    for (int a = 0; a < 3; a++) f->aperture[a][at] = 0, f->velocity[a][at] = 0;
  }
  f->isolated = pores > 0 ? closed / pores : 0;
  solute_flow_measure(f);
  for (size_t at = 0; at < f->count && f->speed > 0; at++)
    if (root_of(parent, (uint32_t)at) == at && volume[at] > STAGNANT_FRACTION * pores &&
        sum[at] > STAGNANT_FRACTION * volume[at] &&
        fabs(sum[at] / volume[at] - 1) > CHANNEL_VELOCITY_TOLERANCE && closed < pores &&
        volume[at] < PORES_KEPT * (pores - closed))
      TRY_FAIL(STATUS_INPUT,
               "the pores are channels that never meet, one with %.3g of the mean velocity: a "
               "solute spreads without end; take a larger sample",
               sum[at] / volume[at]);
cleanup:
  MEMORY_FREE(&parent, &volume, &sum);
  return status;
}

/* Projection: velocity -= the gradient of the potential whose Laplacian is the divergence. */
static enum status project(struct solute_flow *f) {
  enum status status = STATUS_OK;
  static const int axis[3] = {0, 1, 2};
  struct solute_solver solver = {0};
  double *source = NULL, *potential = NULL, before = 0, after = 0, flux = 0, divergence = 0;
  int iterations;
  double reached;
  TRY(solute_solver_build(f, axis, false, 0, &solver));
  struct solute_cells *c = &solver.cells[0];
  TRY(memory_allocate(&source, c->size, sizeof *source, "divergence of the flow"));
  TRY(memory_allocate(&potential, c->size, sizeof *potential, "potential of the projection"));
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const size_t at = solute_cells_at(c, i, j, k);
        for (int a = 0; a < 3; a++) {
          source[at] -= (double)c->flux[a][at + c->stride[a]] - (double)c->flux[a][at];
          flux += (double)c->flux[a][at] * (double)c->flux[a][at];
        }
        divergence += source[at] * source[at];
      }
  const double rounding = divergence > 0 ? sqrt(flux / divergence) : 0;
  const double tolerance = PROJECTION_RESIDUAL * fmax(1, rounding);
  TRY(solute_solver_solve(&solver, source, tolerance, tolerance, potential, &iterations, &reached));
  solute_cells_wrap_exact(c, potential);
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const size_t at = solute_cells_at(c, i, j, k), cell = solute_flow_at(f, i, j, k);
        for (int a = 0; a < 3; a++) {
          const double change =
              -(double)c->conductance[a][at] * (potential[at] - potential[at - c->stride[a]]);
          const double area = c->width[(a + 1) % 3][0] * c->width[(a + 2) % 3][0];
          const double u = (double)f->velocity[a][cell];
          before += u * u;
          after += pow(change / area * f->speed, 2);
          f->velocity[a][cell] = (float)(u + change / area * f->speed);
        }
      }
  f->correction = before > 0 ? sqrt(after / before) : 0;
cleanup:
  solute_solver_free(&solver);
  MEMORY_FREE(&source, &potential);
  return status;
}

/* Whether the pores in layers i and n - 1 - i along an axis are the same, up to rounding, and vary
 * along the axis at all. */
static bool is_mirrored(const struct solute_flow *f, int axis) {
  double difference = 0, change = 0, sum = 0;
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        int x[3] = {i, j, k};
        const double here = (double)f->volume[solute_flow_at(f, i, j, k)];
        x[axis] = f->n[axis] - 1 - x[axis];
        difference += fabs(here - (double)f->volume[solute_flow_at(f, x[0], x[1], x[2])]);
        x[axis] = (f->n[axis] - x[axis]) % f->n[axis]; /* the layer after (i, j, k) */
        change += fabs(here - (double)f->volume[solute_flow_at(f, x[0], x[1], x[2])]);
        sum += fmin(here, 1 - here); /* cells cut by walls */
      }
  return difference < MIRROR_DIFFERENCE * sum && change > MIRROR_DIFFERENCE * sum;
}

enum status solute_flow_finish(struct solute_flow *f) {
  enum status status = STATUS_OK;
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const size_t at = solute_flow_at(f, i, j, k);
        for (int a = 0; a < 3; a++)
          if (!(f->aperture[a][at] > 0)) f->velocity[a][at] = 0;
      }
  solute_flow_measure(f);
  if (!(f->porosity > 0)) return FAIL(STATUS_INPUT, "no cell of the flow holds water");
  TRY(close_isolated(f));
  if (f->speed > 0) {
    TRY(project(f));
    solute_flow_measure(f);
    int most = 0;
    for (int a = 1; a < 3; a++)
      if (fabs(f->mean_velocity[a]) > fabs(f->mean_velocity[most])) most = a;
    for (int a = 0; a < 3; a++) f->image[a] = is_mirrored(f, a);
    f->mirrored = f->image[most];
  }
cleanup:
  return status;
}

enum status solute_flow_build(const int n[3], const double spacing[3],
                              double (*distance)(const void *context, const double x[3]),
                              void (*velocity)(const void *context, const double x[3], double u[3]),
                              const void *context, struct solute_flow *f) {
  enum status status = STATUS_OK;
  enum { POINTS = 8 };
  TRY(solute_flow_allocate(n, spacing, f));
  for (int a = 0; a < 3; a++) f->origin[a] = 0.5 * spacing[a];
  for (int k = 0; k < n[2]; k++)
    for (int j = 0; j < n[1]; j++)
      for (int i = 0; i < n[0]; i++) {
        const double x[3] = {(i + 0.5) * spacing[0], (j + 0.5) * spacing[1],
                             (k + 0.5) * spacing[2]};
        f->distance[solute_flow_at(f, i, j, k)] = (float)distance(context, x);
      }
  solute_flow_cut(f);
  for (size_t at = 0; at < f->count && velocity != NULL; at++)
    for (int a = 0; a < 3; a++) {
      const size_t x[3] = {at % (size_t)n[0], at / (size_t)n[0] % (size_t)n[1],
                           at / (size_t)n[0] / (size_t)n[1]};
      double sum = 0;
      if (!(f->aperture[a][at] > 0)) continue;
      for (int p = 0; p < POINTS * POINTS; p++) {
        double y[3], u[3];
        const int column = p % POINTS, row = p / POINTS;
        const double share[2] = {(column + 0.5) / POINTS, (row + 0.5) / POINTS};
        for (int b = 0; b < 3; b++)
          y[b] = ((double)x[b] + (b == a ? 0 : share[(b - a + 3) % 3 - 1])) * spacing[b];
        if (!(distance(context, y) > 0)) continue;
        velocity(context, y, u);
        sum += u[a];
      }
      f->velocity[a][at] = (float)(sum / (POINTS * POINTS));
    }
  TRY(solute_flow_finish(f));
cleanup:
  if (status != STATUS_OK) solute_flow_free(f);
  return status;
}
