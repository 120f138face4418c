#include "analyze/seepage/plane_balance.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/memory.h"

/* Whether water may enter or leave between two positions on an axis (0 x, 1 z). */
static bool is_open_between(const struct head_field *f, int axis, double a, double b) {
  for (size_t r = 0; r < f->region_count; r++)
    if ((!strcmp(f->regions[r].type, "inflow") || head_region_is_source(&f->regions[r])) &&
        f->regions[r].low[axis] < fmax(a, b) && f->regions[r].high[axis] > fmin(a, b))
      return true;
  return false;
}

/* Flux through row or column n of cells, and its wet lengths in soil and in free water. */
static double section(const struct head_field *f, int axis, size_t n, double *soil, double *water) {
  const size_t along = axis == 0 ? f->nz : f->nx;
  const double length = axis == 0 ? f->dz : f->dx;
  double flux = 0;
  *soil = *water = 0;
  for (size_t m = 0; m < along; m++) {
    const size_t c = axis == 0 ? m * f->nx + n : n * f->nx + m;
    if (f->wall[c] != REGION_NONE || isnan(f->head[c])) continue;
    *(f->soil[c] != REGION_NONE ? soil : water) += length;
    flux += length * f->velocity[axis][c];
  }
  return flux;
}

double plane_balance(const struct run *run, const struct head_field *f, const char *name,
                     double mean, bool *in_water) {
  int axis = 0;
  double place = 0, soil, water, sum = 0, squares = 0, count = 0;
  if (in_water != NULL) *in_water = false;
  if (!place_of_plane(run, name, &axis, &place) || (axis != 0 && axis != 2)) return NAN;
  if (axis == 2) axis = 1; /* index in head_field: x, z */
  const size_t sections = axis == 0 ? f->nx : f->nz;
  const double step = axis == 0 ? f->dx : f->dz;
  for (size_t n = 0; n < sections; n++) {
    const double at = ((double)n + 0.5) * step;
    const double flux = section(f, axis, n, &soil, &water);
    if (fabs(at - place) <= 0.51 * step && water > 0 && in_water != NULL) *in_water = true;
    if (water > 0 || !(soil > 0) || is_open_between(f, axis, at, place)) continue;
    sum += flux, squares += flux * flux, count++;
  }
  if (count < 3) return NAN;
  const double reference = sum / count;
  const double scatter = 2 * sqrt(fmax(0, squares / count - reference * reference) /
                                  fmax(1, count / SECTIONS_CORRELATED));
  return hypot(mean - reference, scatter);
}

/* Reads the row of [n][width] numbers that belongs to a name; false if there is none. */
static bool find(const struct run *run, const char *group, const char *numbers, size_t width,
                 const char *name, double *row) {
  struct h5_file *file = NULL;
  char **names = NULL, path[2][64];
  double *values = NULL;
  size_t n = 0, dims[2] = {0, 0};
  bool found = false;
  snprintf(path[0], sizeof path[0], "%s/name", group);
  snprintf(path[1], sizeof path[1], "%s/%s", group, numbers);
  if (h5_open(run->path, &file) == STATUS_OK && h5_exists(file, path[0]) &&
      h5_read_texts(file, path[0], &n, &names) == STATUS_OK &&
      h5_read(file, path[1], H5_F64, 2, dims, &values) == STATUS_OK && dims[0] == n &&
      dims[1] == width)
    for (size_t k = 0; k < n; k++)
      if (!strcmp(names[k], name)) {
        found = true;
        memcpy(row, values + width * k, width * sizeof *row);
      }
  error_clear();
  h5_free_texts(n, &names);
  memory_free(&values);
  h5_close(file);
  return found;
}

bool place_of_plane(const struct run *run, const char *name, int *axis, double *place) {
  double row[2];
  if (!find(run, "/run/planes", "axis_position", 2, name, row)) return false;
  *axis = (int)row[0], *place = row[1];
  return true;
}

bool place_of_gauge(const struct run *run, const char *name, double place[3]) {
  return find(run, "/run/gauges", "position", 3, name, place);
}
