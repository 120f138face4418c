#include "analyze/run_places.h"

#include <stdio.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/memory.h"

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
