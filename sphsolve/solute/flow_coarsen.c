#include <math.h>

#include "sphsolve/solute/flow.h"

/* Coarsens to half as many cells along one axis, rounded up. For an odd number the coarse cells are
 * a little less than twice as long, and their faces lie within cells of the fine flow. There the
 * flux along the axis varies linearly with the position (as in a cell with uniform fluxes through
 * its other faces: Pollock 1988), so that the coarse fluxes are divergence-free. */
static enum status coarsen_along(const struct solute_flow *fine, int axis, struct solute_flow *c) {
  enum status status = STATUS_OK;
  int n[3] = {fine->n[0], fine->n[1], fine->n[2]};
  double spacing[3] = {fine->spacing[0], fine->spacing[1], fine->spacing[2]};
  n[axis] = (fine->n[axis] + 1) / 2;
  const double ratio = (double)fine->n[axis] / n[axis];
  spacing[axis] *= ratio;
  TRY(solute_flow_allocate(n, spacing, c));
  for (int a = 0; a < 3; a++)
    c->origin[a] = fine->origin[a] + 0.5 * (spacing[a] - fine->spacing[a]);
#pragma omp parallel for schedule(static)
  for (int k = 0; k < n[2]; k++)
    for (int j = 0; j < n[1]; j++)
      for (int i = 0; i < n[0]; i++) {
        const size_t at = solute_flow_at(c, i, j, k);
        int x[3] = {i, j, k};
        const double low = x[axis] * ratio, high = low + ratio;
        const int first = (int)low;
        for (int cell = first; cell < high && cell < fine->n[axis]; cell++) {
          const float share =
              (float)((fmin(cell + 1, high) - fmax(cell, low)) / ratio); /* of the coarse cell */
          x[axis] = cell;
          const size_t from = solute_flow_at(fine, x[0], x[1], x[2]);
          c->distance[at] += share * fine->distance[from];
          c->volume[at] += share * fine->volume[from];
          for (int a = 0; a < 3; a++) {
            if (a == axis) continue;
            c->aperture[a][at] += share * fine->aperture[a][from];
            c->velocity[a][at] += share * fine->velocity[a][from];
          }
        }
        const float along = (float)(low - first);
        x[axis] = first;
        const size_t here = solute_flow_at(fine, x[0], x[1], x[2]);
        x[axis] = first + 1;
        const size_t next = solute_flow_at(fine, x[0], x[1], x[2]);
        c->aperture[axis][at] = (1 - along) * fine->aperture[axis][here];
        c->velocity[axis][at] = (1 - along) * fine->velocity[axis][here];
        if (!(along > 0)) continue;
        c->aperture[axis][at] += along * fine->aperture[axis][next];
        c->velocity[axis][at] += along * fine->velocity[axis][next];
      }
cleanup:
  return status;
}

enum status solute_flow_coarsen(const struct solute_flow *fine, struct solute_flow *coarse) {
  enum status status = STATUS_OK;
  struct solute_flow stage[3] = {0};
  const struct solute_flow *from = fine;
  for (int a = 0; a < 3; a++) {
    TRY(coarsen_along(from, a, &stage[a]));
    from = &stage[a];
  }
  *coarse = stage[2];
  stage[2] = (struct solute_flow){0};
  coarse->viscosity = fine->viscosity, coarse->density = fine->density;
  coarse->isolated = fine->isolated, coarse->correction = fine->correction;
  solute_flow_measure(coarse);
  coarse->grain_size = fine->grain_size;
cleanup:
  for (int a = 0; a < 3; a++) solute_flow_free(&stage[a]);
  return status;
}
