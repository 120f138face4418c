#include "sphsolve/solute/result.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/constants.h"
#include "common/hdf5_file.h"
#include "common/provenance.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/volumes.h"
#include "sphsolve/solute/walk.h"
#include "common/memory.h"

/* Tracks of selected walkers, for ParaView. */

#define TRACKS_TIMES 256 /* most times written: of longer walks every second, third, ... */

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

/* Writes a VTKHDF UnstructuredGrid with one line per walker, in the unwrapped periodic box (m),
 * with `time` (s) and `id` at each point. `record`: after walk_record_write, its positions in m;
 * `interval`: s between two of them. The other arguments: those of provenance_write. */
static enum status tracks_write(const char *path, const struct solute_flow *flow,
                                const struct walk_record *r, double interval,
                                const char *command_line, size_t inputs, const char *const *input,
                                const uint64_t *hashes) {
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

static enum status write_number(struct h5_file *file, const char *name, double value) {
  return h5_write_attribute(file, "/solute", name, H5_F64, 1, &value);
}

/* Writes /solute/NAME over the Peclet numbers: the member at `offset` of each of `items`. */
static enum status write_column(struct h5_file *file, const char *name, int count,
                                const void *items, size_t size, size_t offset) {
  double values[SOLUTE_PECLET_MAX];
  char path[128];
  const size_t dims[1] = {(size_t)count};
  for (int i = 0; i < count; i++)
    memcpy(&values[i], (const char *)items + (size_t)i * size + offset, sizeof *values);
  snprintf(path, sizeof path, "/solute/%s", name);
  return h5_write(file, path, H5_F64, 1, dims, values, false);
}

/* Writes the estimate at `offset` of each of `items` to /solute/GROUP; `group` is "" or ends in
 * '/'. */
static enum status write_estimates(struct h5_file *file, const char *group, int count,
                                   const void *items, size_t size, size_t offset) {
  static const struct {
    const char *name;
    size_t offset;
  } columns[] = {
      {"longitudinal", offsetof(struct solute_estimate, longitudinal)},
      {"transverse", offsetof(struct solute_estimate, transverse)},
      {"longitudinal_error", offsetof(struct solute_estimate, longitudinal_error)},
      {"transverse_error", offsetof(struct solute_estimate, transverse_error)},
  };
  enum status status = STATUS_OK;
  char name[64];
  for (size_t c = 0; c < sizeof columns / sizeof *columns; c++) {
    snprintf(name, sizeof name, "%s%s", group, columns[c].name);
    TRY(write_column(file, name, count, items, size, offset + columns[c].offset));
  }
cleanup:
  return status;
}

static enum status write_closure(struct h5_file *file, const struct solute_result *r) {
  enum status status = STATUS_OK;
#define COLUMN(name, member)                                                                       \
  TRY(write_column(file, "closure/" name, r->count, r->closure, sizeof *r->closure,                \
                   offsetof(struct solute_closed, member)))
  double tensor[SOLUTE_PECLET_MAX][9];
  const size_t dims[3] = {(size_t)r->count, 3, 3};
  TRY(write_estimates(file, "closure/", r->count, r->closure, sizeof *r->closure,
                      offsetof(struct solute_closed, value)));
  COLUMN("longitudinal_resolution", resolution[0]);
  COLUMN("transverse_resolution", resolution[1]);
  COLUMN("longitudinal_projection", projection[0]);
  COLUMN("transverse_projection", projection[1]);
  COLUMN("solver", solver);
  COLUMN("longitudinal_sample", sample[0]);
  COLUMN("transverse_sample", sample[1]);
  COLUMN("longitudinal_repeats", repeats[0]);
  COLUMN("transverse_repeats", repeats[1]);
#undef COLUMN
  for (int i = 0; i < r->count; i++)
    for (int e = 0; e < 9; e++) tensor[i][e] = r->closure[i].tensor[e / 3][e % 3];
  TRY(h5_write(file, "/solute/closure/tensor", H5_F64, 3, dims, tensor, false));
cleanup:
  return status;
}

/* Time unit of a walk, s: h / U, or h^2 / D without flow. */
static double time_unit(const struct solute_flow *flow, const struct solute_result *r, int i) {
  const double h = flow->spacing[0];
  return r->peclet[i] > 0 && flow->speed > 0 ? h / flow->speed : h * h / r->diffusion;
}

static enum status write_walk(struct h5_file *file, const struct solute_flow *flow,
                              const struct solute_result *r) {
  enum status status = STATUS_OK;
#define COLUMN(name, member)                                                                       \
  TRY(write_column(file, "walk/" name, r->count, r->walk, sizeof *r->walk,                         \
                   offsetof(struct solute_walked, member)))
  TRY(write_estimates(file, "walk/", r->count, r->walk, sizeof *r->walk,
                      offsetof(struct solute_walked, value)));
  COLUMN("longitudinal_statistics", statistics[0]);
  COLUMN("transverse_statistics", statistics[1]);
  COLUMN("longitudinal_asymptotics", asymptotics[0]);
  COLUMN("transverse_asymptotics", asymptotics[1]);
  COLUMN("longitudinal_resolution", resolution[0]);
  COLUMN("transverse_resolution", resolution[1]);
#undef COLUMN
  for (int i = 0; i < r->count; i++) {
    char group[64];
    snprintf(group, sizeof group, "/solute/walk/%d", i);
    TRY(walk_record_write(file, group, &r->record[i], flow->spacing[0], time_unit(flow, r, i)));
  }
cleanup:
  return status;
}

static enum status write_solute(struct h5_file *file, const struct scene *scene,
                                const struct solute_flow *flow, const struct solute_result *r) {
  enum status status = STATUS_OK;
  const size_t dims[1] = {(size_t)r->count};
  uint64_t size[3];
  for (int a = 0; a < 3; a++) size[a] = (uint64_t)flow->n[a];
  TRY(h5_make_group(file, "/solute"));
  TRY(h5_write_attribute_text(file, "/solute", "flow", scene->flow_path));
  TRY(h5_write_attribute(file, "/solute", "mean_velocity", H5_F64, 3, flow->mean_velocity));
  TRY(h5_write_attribute(file, "/solute", "spacing", H5_F64, 3, flow->spacing));
  TRY(h5_write_attribute(file, "/solute", "size", H5_U64, 3, size));
  TRY(h5_write_attribute(file, "/solute", "dimensions", H5_I32, 1, &flow->dimensions));
  const int mirrored = flow->mirrored;
  TRY(h5_write_attribute(file, "/solute", "mirrored", H5_I32, 1, &mirrored));
  TRY(write_number(file, "speed", flow->speed));
  TRY(write_number(file, "porosity", flow->porosity));
  TRY(write_number(file, "isolated", flow->isolated));
  TRY(write_number(file, "grain_size", flow->grain_size));
  TRY(write_number(file, "correction", flow->correction));
  TRY(write_number(file, "length", r->length));
  TRY(write_number(file, "diffusion", r->diffusion));
  TRY(write_number(file, "formation_factor", r->formation));
  TRY(write_number(file, "formation_factor_error", r->formation_error));
  TRY(write_number(file, "formation_factor_sample", r->formation_sample));
  TRY(write_number(file, "tortuosity", r->tortuosity));
  TRY(h5_write_attribute(file, "/solute", "correlation_length", H5_F64, 2, r->correlation));
  TRY(h5_write(file, "/solute/peclet", H5_F64, 1, dims, r->peclet, false));
  TRY(write_estimates(file, "", r->count, r->best, sizeof *r->best, 0));
  if (r->by_closure) TRY(write_closure(file, r));
  if (r->by_walk) TRY(write_walk(file, flow, r));
cleanup:
  return status;
}

enum status solute_result_write(const struct scene *scene, const struct solute_flow *flow,
                                const struct solute_result *r, const char *prefix,
                                const char *command_line) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  char path[4200];
  const char *inputs[2] = {scene->path, scene->flow_path};
  uint64_t hashes[2] = {hash_bytes(scene->text, strlen(scene->text)), 0};
  TRY(hash_file(scene->flow_path, &hashes[1]));
  snprintf(path, sizeof path, "%s.hdf", prefix);
  TRY(h5_create(path, &file));
  TRY(h5_make_group(file, "/run"));
  TRY(h5_write_attribute_text(file, "/run", "method", "solute"));
  TRY(h5_write_attribute_text(file, "/run", "status", r->status));
  TRY(h5_write_attribute_text(file, "/run", "scene_name", scene->name));
  TRY(h5_write_text(file, "/run/scene", scene->text));
  const struct constant *tables[] = {common_constants, solute_constants};
  TRY(constants_write(file, sizeof tables / sizeof *tables, tables));
  TRY(h5_make_group(file, "/run/timing"));
  TRY(h5_write_attribute(file, "/run/timing", "wall_time", H5_F64, 1, &r->wall_time));
  TRY(write_solute(file, scene, flow, r));
  TRY(provenance_write(file, "sphsolve", command_line, 2, inputs, hashes));
  status = h5_commit(file);
  file = NULL;
  for (int i = 0; i < r->count && r->by_walk && status == STATUS_OK; i++) {
    snprintf(path, sizeof path, "%s-tracks-%d.hdf", prefix, i);
    status = tracks_write(path, flow, &r->record[i], time_unit(flow, r, i) * r->record[i].interval,
                          command_line, 2, inputs, hashes);
  }
cleanup:
  h5_close(file);
  return status;
}
