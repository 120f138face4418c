/* ranks_stokes OUT.hdf [adami]: one application of method stokes' operator, residual, flux and
 * preconditioner to a vector that depends on the site alone. ranks.bats holds the files of the
 * program without MPI and with 1, 2, 3 and 4 ranks against each other. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/stokes/solver/state.h"

enum { NX = 19, NY = 14, NZ = 37 };

/* Periodic balls on a sheared lattice: nothing repeats from slab to slab. */
static double ball_distance(double x, double y, double z) {
  const double centres[4][4] = {
      {4, 4, 5, 4.4}, {13, 9, 12, 4.9}, {6, 11, 22, 5.2}, {15, 3, 31, 4.1}};
  const double size[3] = {NX, NY, NZ};
  double least = 1e9;
  for (int b = 0; b < 4; b++) {
    const double d[3] = {x - centres[b][0], y - centres[b][1], z - centres[b][2]};
    double square = 0;
    for (int a = 0; a < 3; a++) {
      const double r = d[a] - size[a] * round(d[a] / size[a]);
      square += r * r;
    }
    least = fmin(least, sqrt(square) - centres[b][3]);
  }
  return least;
}

static enum status build_lattice(struct lattice *l) {
  enum status status = STATUS_OK;
  *l = (struct lattice){.dimensions = 3, .size = {NX, NY, NZ}, .count = NX * NY * NZ};
  l->bulk_count = (double)l->count;
  for (int a = 0; a < 3; a++) l->spacing[a] = 1;
  TRY(memory_allocate(&l->kind, l->count, 1, "lattice"));
  TRY(memory_allocate(&l->wall_distance, l->count, sizeof(float), "lattice"));
  for (size_t s = 0; s < l->count; s++) {
    const double d = ball_distance((double)(s % NX), (double)(s / NX % NY), (double)(s / NX / NY));
    l->kind[s] = d > 0 ? SITE_FLUID : SITE_WALL;
    l->wall_distance[s] = (float)(fabs(d) > 1e-3 ? d : d > 0 ? 1e-3 : -1e-3);
    l->fluid_count += d > 0;
    l->wall_count += d <= 0;
  }
cleanup:
  return status;
}

static double value_at(size_t site, int component) {
  return sin(0.37 * (double)site + component) + 0.2 * cos(0.011 * (double)(site * site % 997));
}

static enum status write_vector(struct h5_file *file, const char *name, size_t n, const float *y) {
  enum status status = STATUS_OK;
  for (size_t c = 0; c < 4; c++) {
    char path[64];
    snprintf(path, sizeof path, "/%s%zu", name, c);
    TRY(h5_write_rows(file, path, H5_F32, 1, &n, y + c * n, false));
  }
cleanup:
  return status;
}

int main(int argc, char **argv) {
  enum status status = STATUS_OK;
  struct lattice lattice = {0};
  struct stokes_solver s = {0};
  struct h5_file *file = NULL;
  float *x = NULL, *y = NULL;
  double flux[3];
  const double driving[3] = {0.3, -0.2, 1};
  size_t three = 3;
  ranks_start(&argc, &argv);
  if (argc < 2) TRY_FAIL(STATUS_USAGE, "ranks_stokes OUT.hdf [adami]");
  TRY(build_lattice(&lattice));
  TRY(stokes_solver_build(&lattice, NULL, 2.9, argc > 2 ? WALL_ADAMI : WALL_SUBVOXEL, 1, driving,
                          &s));
  const struct stokes_grid *grid = &s.grid;
  const size_t n = grid->active;
  TRY(memory_allocate(&x, 4 * n + 1, sizeof *x, "vector"));
  TRY(memory_allocate(&y, 4 * n + 1, sizeof *y, "vector"));
  for (size_t row = grid->row_begin, at = 0; row < grid->row_end; row++)
    for (size_t i = 0; i < NX; i++) {
      if (!stokes_grid_is_active(grid, row, i)) continue;
      for (int c = 0; c < 4; c++) {
        s.x[(size_t)c * n + at] = value_at(row * NX + i, c);
        x[(size_t)c * n + at] = (float)s.x[(size_t)c * n + at];
      }
      at++;
    }
  TRY(h5_create(argv[1], &file));
  stokes_operator_apply(&s.operator, x, y);
  TRY(write_vector(file, "operator", n, y));
  stokes_operator_apply_gradient(&s.operator, x, y);
  stokes_operator_flux(&s.operator, s.force, s.x, y, flux);
  TRY(h5_write(file, "/flux", H5_F64, 1, &three, flux, false));
  stokes_operator_residual(&s.operator, s.force, s.x, (double *)(void *)s.krylov.basis, y);
  TRY(write_vector(file, "residual", n, y));
  stokes_preconditioner_apply(&s.preconditioner, x, s.krylov.basis, y);
  TRY(write_vector(file, "preconditioner", n, y));
  status = h5_commit(file);
  file = NULL;
cleanup:
  h5_close(file);
  stokes_solver_free(&s);
  lattice_free(&lattice);
  memory_free(&x);
  memory_free(&y);
  return ranks_end(status);
}
