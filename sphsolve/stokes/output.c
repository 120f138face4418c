/* Snapshots of method stokes: all fluid sites; those in pores without through-flow have zero
 * velocity. */

#include "sphsolve/stokes/output.h"

#include <math.h>

#include "common/hdf5_file.h"
#include "common/memory.h"

struct fields {
  double *points;
  float *velocity, *pressure, *density;
  float *micro_porosity; /* NULL: the lattice has no soil */
  uint64_t *id;
};

static void fields_free(struct fields *f) {
  MEMORY_FREE(&f->points, &f->velocity, &f->pressure, &f->density, &f->micro_porosity, &f->id);
}

enum status stokes_write_snapshot(const struct scene *scene, const struct lattice *lattice,
                                  const struct stokes_solver *s, struct recorder *recorder) {
  enum status status = STATUS_OK;
  struct fields f = {0};
  const size_t nx = lattice->size[0], n = s->grid.active;
  const size_t first = s->grid.row_begin * nx;
  const size_t end = (s->grid.mirrored ? s->grid.rows : s->grid.row_end) * nx;
  size_t count = 0;
  for (size_t site = first; site < end; site++) count += lattice->kind[site] == SITE_FLUID;
  const size_t axes = (size_t)s->stencil.axis_count;
  const double density = scene->fluid.density;
  const double pressure_unit = density * s->acceleration * s->stencil.unit;
  TRY(memory_allocate(&f.velocity, 3 * count, sizeof *f.velocity, "velocity of the snapshot"));
  TRY(memory_allocate(&f.pressure, count, sizeof *f.pressure, "pressure of the snapshot"));
  TRY(memory_allocate(&f.density, count, sizeof *f.density, "density of the snapshot"));
  if (lattice->micro_porosity != NULL)
    TRY(memory_allocate(&f.micro_porosity, count, sizeof *f.micro_porosity,
                        "soil of the snapshot"));
  TRY(memory_allocate(&f.id, count, sizeof *f.id, "ids of the snapshot"));
  for (size_t site = first, at = 0, packed = 0; site < end; site++) {
    const size_t i = site % nx, row = site / nx;
    const bool image = row >= s->grid.row_end;
    if (i == 0 && n > 0) packed = s->grid.row_start[image ? stokes_grid_image(&s->grid, row) : row];
    if (lattice->kind[site] != SITE_FLUID) continue;
    f.density[at] = (float)density;
    f.id[at] = site;
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference): it is there if the lattice's is
    if (f.micro_porosity != NULL) f.micro_porosity[at] = lattice->micro_porosity[site];
    if (n > 0 && stokes_grid_is_active(&s->grid, row, i)) {
      for (size_t a = 0; a < axes; a++) {
        const int axis = s->stencil.axes[a];
        f.velocity[3 * at + (size_t)axis] = (image ? s->grid.parity[axis] : 1.0f) *
                                            (float)(s->x[a * n + packed] * s->velocity_unit);
      }
      f.pressure[at] =
          (image ? s->grid.parity[3] : 1.0f) * (float)(s->x[axes * n + packed] * pressure_unit);
      packed++;
    }
    at++;
  }
  /* After a signal neither file is completed: the solution goes into a checkpoint, and the resumed
   * run writes them. The image is written first, because a snapshot counts as complete as soon
   * as it exists. */
  h5_leave_on_signal(true);
  TRY(recorder_image(recorder, lattice, 0.0, s->iterations, count, f.id, f.velocity, f.pressure));
  TRY(memory_allocate(&f.points, 3 * count, sizeof *f.points, "points of the snapshot"));
#pragma omp parallel for schedule(static)
  for (size_t p = 0; p < count; p++) {
    const size_t row = f.id[p] / nx;
    const size_t xyz[3] = {f.id[p] % nx, row % lattice->size[1], row / lattice->size[1]};
    for (int a = 0; a < 3; a++)
      f.points[3 * p + (size_t)a] = lattice->origin[a] + (double)xyz[a] * lattice->spacing[a];
  }
  const struct snapshot_field list[] = {
      {"velocity", "m/s", "velocity", H5_F32, 3, f.velocity, NULL, NULL},
      {"pressure", "Pa", "pressure without the part that drives the flow", H5_F32, 1, f.pressure,
       NULL, NULL},
      {"density", "kg/m^3", "density", H5_F32, 1, f.density, NULL, NULL},
      {"id", "1", "number of the lattice site, x fastest", H5_U64, 1, f.id, NULL, NULL},
      {"micro_porosity", "1", "porosity of soil with pores below the voxel; 0 elsewhere", H5_F32, 1,
       f.micro_porosity, NULL, NULL}};
  const size_t fields = sizeof list / sizeof *list - (f.micro_porosity == NULL);
  const struct snapshot_field points = {.type = H5_F64, .components = 3, .data = f.points};
  TRY(recorder_snapshot(recorder, 0.0, s->iterations, count, &points, fields, list));
cleanup:
  h5_leave_on_signal(false);
  fields_free(&f);
  return status;
}

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
