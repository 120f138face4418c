/* Snapshots of method stokes: all fluid sites; those in pores without through-flow have zero
 * velocity. */
#include "sphsolve/stokes/output.h"

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
