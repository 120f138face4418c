#include "sphsolve/solute/tracks.h"

#include <string.h>

#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/provenance.h"

#define POLY_LINE 4 /* VTK's number of this type of cell */

static enum status write_lines(struct h5_file *file, size_t points, size_t times) {
  enum status status = STATUS_OK;
  int64_t *number = NULL;
  uint8_t type[WALK_TRACKED];
  const size_t one = 1, lines = WALK_TRACKED, ends = lines + 1;
  const int64_t counts[2] = {(int64_t)points, (int64_t)lines};
  TRY(memory_allocate(&number, points + ends, sizeof *number, "tracks of walkers"));
  for (size_t i = 0; i < points; i++) number[i] = (int64_t)i;
  TRY(h5_write(file, "/VTKHDF/Connectivity", H5_I64, 1, &points, number, true));
  for (size_t i = 0; i < ends; i++) number[i] = (int64_t)(i * times);
  TRY(h5_write(file, "/VTKHDF/Offsets", H5_I64, 1, &ends, number, true));
  memset(type, POLY_LINE, sizeof type);
  TRY(h5_write(file, "/VTKHDF/Types", H5_U8, 1, &lines, type, true));
  TRY(h5_write(file, "/VTKHDF/NumberOfPoints", H5_I64, 1, &one, &counts[0], false));
  TRY(h5_write(file, "/VTKHDF/NumberOfCells", H5_I64, 1, &one, &counts[1], false));
  TRY(h5_write(file, "/VTKHDF/NumberOfConnectivityIds", H5_I64, 1, &one, &counts[0], false));
cleanup:
  memory_free(&number);
  return status;
}

enum status tracks_write(const char *path, const struct solute_flow *flow,
                         const struct walk_record *r, double interval, const char *command_line,
                         size_t inputs, const char *const *input, const uint64_t *hashes) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  const size_t step = (r->tracked + TRACKS_TIMES - 1) / TRACKS_TIMES;
  const size_t times = step > 0 ? (r->tracked + step - 1) / step : 0, points = times * WALK_TRACKED;
  const size_t dims[2] = {points, 3};
  const int version[2] = {1, 0};
  float *place = NULL, *time = NULL;
  int32_t *id = NULL;
  if (points == 0) return STATUS_OK;
  TRY(memory_allocate(&place, 3 * points, sizeof *place, "tracks of walkers"));
  TRY(memory_allocate(&time, points, sizeof *time, "tracks of walkers"));
  TRY(memory_allocate(&id, points, sizeof *id, "tracks of walkers"));
  for (size_t w = 0; w < WALK_TRACKED; w++)
    for (size_t t = 0; t < times; t++) {
      const size_t to = w * times + t;
      for (size_t a = 0; a < 3; a++)
        place[3 * to + a] = (float)(flow->origin[a] + (double)r->track[t * step][w][a]);
      time[to] = (float)(interval * (double)(t * step + 1));
      id[to] = (int32_t)w;
    }
  TRY(h5_create(path, &file));
  TRY(h5_make_group(file, "/VTKHDF"));
  TRY(h5_write_attribute(file, "/VTKHDF", "Version", H5_I32, 2, version));
  TRY(h5_write_attribute_text(file, "/VTKHDF", "Type", "UnstructuredGrid"));
  TRY(h5_write(file, "/VTKHDF/Points", H5_F32, 2, dims, place, true));
  TRY(write_lines(file, points, times));
  TRY(h5_write(file, "/VTKHDF/PointData/time", H5_F32, 1, dims, time, true));
  TRY(h5_write_attribute_text(file, "/VTKHDF/PointData/time", "unit", "s"));
  TRY(h5_write(file, "/VTKHDF/PointData/id", H5_I32, 1, dims, id, true));
  TRY(provenance_write(file, "sphsolve", command_line, inputs, input, hashes));
  status = h5_commit(file);
  file = NULL;
cleanup:
  h5_close(file);
  MEMORY_FREE(&place, &time, &id);
  return status;
}
