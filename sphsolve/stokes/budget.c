#include "sphsolve/stokes/budget.h"

#include <math.h>

#include "common/memory.h"

/* Balance of volume, momentum and energy, independent of the solver's residual norm: the variation
 * of the flux between planes across the force (plain sums over sites, without the parts of walls
 * within a site), the net force on the water, and the net power. Where moving walls drive the water
 * in circles, the planes are those across the axis of the largest velocities, and the flux is
 * compared with the sum of the absolute velocities. */
enum status stokes_balance(const struct stokes_solver *s, struct conservation *conservation) {
  enum status status = STATUS_OK;
  const struct stokes_grid *grid = &s->grid;
  const size_t n = grid->active, first[3] = {0, grid->size[0], grid->size[0] + grid->size[1]};
  const size_t planes = first[2] + grid->size[2];
  struct {
    double left[3], driving[3], flow[3], power_left, power;
  } sum = {{0}, {0}, {0}, 0, 0};
  double *flux = NULL, open = 0, driving = 0, square = 0;
  int main_axis = 0;
  TRY(memory_allocate(&flux, planes, sizeof *flux, "the conservation budget"));
  for (int c = 0; c < s->stencil.axis_count; c++) {
    const int a = s->stencil.axes[c];
    const double *u = s->x + (size_t)c * n;
    if (grid->mirrored && grid->parity[a] < 0.0f) continue; /* both halves cancel */
    for (size_t row = stokes_grid_begin(grid), p = 0; row < stokes_grid_end(grid); row++)
      for (size_t i = 0; i < grid->size[0]; i++) {
        if (!stokes_grid_is_active(grid, row, i)) continue;
        const size_t at[3] = {i, row % grid->size[1], row / grid->size[1]};
        flux[first[a] + at[a]] += u[p++];
      }
    for (size_t i = 0; i < n; i++) {
      double left = (double)s->residual[(size_t)c * n + i];
      if (s->operator.soil) left /= (double)s->operator.soil->row_scale[i];
      const double given =
          s->force[a] + (s->walls_move ? (double)s->operator.drag[(size_t)c * n + i] : 0);
      sum.left[a] += left;
      sum.driving[a] += fabs(given);
      sum.flow[a] += s->walls_move ? fabs(u[i]) : u[i];
      sum.power_left += left * u[i];
      sum.power += given * u[i];
    }
  }
  ranks_sum_all(flux, planes);
  ranks_sum_all((double *)&sum, sizeof sum / sizeof(double));
  const double *size = s->walls_move ? sum.flow : s->force;
  for (int a = 1; a < 3; a++)
    if (fabs(size[a]) > fabs(size[main_axis])) main_axis = a;
  const size_t main_planes = main_axis == 2 ? stokes_grid_planes(grid) : grid->size[main_axis];
  const double count = (double)main_planes, scale = sum.flow[main_axis] / count;
  double mean = 0;
  for (size_t i = 0; i < main_planes; i++) mean += flux[first[main_axis] + i] / count;
  for (size_t i = 0; i < main_planes; i++) {
    const double off = (flux[first[main_axis] + i] - mean) / scale;
    square += off * off / count;
  }
  for (int a = 0; a < 3; a++) {
    open = hypot(open, sum.left[a]);
    driving = hypot(driving, sum.driving[a]);
  }
  conservation->steady = true;
  conservation->flux_open = sqrt(square);
  conservation->force_open = open / driving;
  conservation->power_open = fabs(sum.power_left / sum.power);
cleanup:
  memory_free(&flux);
  return status;
}
