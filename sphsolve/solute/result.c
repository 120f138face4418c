#include "sphsolve/solute/result.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/constants.h"
#include "common/hdf5_table.h"
#include "common/provenance.h"
#include "common/ranks.h"
#include "common/snapshot_file.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/volumes.h"
#include "sphsolve/solute/walk.h"
#include "common/memory.h"

/* Tracks of selected walkers, for ParaView. */

#define TRACKS_TIMES 256 /* most times written: of longer walks every second, third, ... */

/* Writes a VTKHDF UnstructuredGrid with one line per walker, in the unwrapped periodic box (m),
 * with `time` (s) and `id` at each point. `record`: after walk_record_write. The
 * other arguments: those of provenance_write. */
static enum status tracks_write(const char *path, const struct solute_flow *flow,
                                const struct walk_record *r, const char *command_line,
                                size_t inputs, const char *const *input, const uint64_t *hashes) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  const size_t step = (r->tracked + TRACKS_TIMES - 1) / TRACKS_TIMES;
  const size_t times = step > 0 ? (r->tracked + step - 1) / step : 0, points = times * WALK_TRACKED;
  const size_t dims[2] = {points, 3};
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
      time[to] = (float)(r->interval * (double)(t * step + 1));
      id[to] = (int32_t)w;
    }
  TRY(h5_create(path, &file));
  const struct snapshot_field at = {.type = H5_F32, .components = 3, .data = place};
  TRY(snapshot_write_grid(file, ranks_own() == 0 ? points : 0, &at, times, VTK_POLY_LINE));
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

/* Writes /solute/GROUP over the Peclet numbers; the first of the estimates, which are `stride`
 * bytes apart. */
static enum status write_estimates(struct h5_file *file, const char *group, int count,
                                   const struct solute_estimate *first, size_t stride) {
  const struct h5_column columns[] = {{"longitudinal", H5_F64, 1, &first->longitudinal},
                                      {"transverse", H5_F64, 1, &first->transverse},
                                      {"longitudinal_error", H5_F64, 1, &first->longitudinal_error},
                                      {"transverse_error", H5_F64, 1, &first->transverse_error}};
  return h5_write_columns(file, group, (size_t)count, stride, 4, columns);
}

static enum status write_closure(struct h5_file *file, const struct solute_result *r) {
  enum status status = STATUS_OK;
  const struct solute_closed *c = r->closure;
  const struct h5_column columns[] = {{"longitudinal_resolution", H5_F64, 1, &c->resolution[0]},
                                      {"transverse_resolution", H5_F64, 1, &c->resolution[1]},
                                      {"longitudinal_projection", H5_F64, 1, &c->projection[0]},
                                      {"transverse_projection", H5_F64, 1, &c->projection[1]},
                                      {"solver", H5_F64, 1, &c->solver},
                                      {"longitudinal_sample", H5_F64, 1, &c->sample[0]},
                                      {"transverse_sample", H5_F64, 1, &c->sample[1]},
                                      {"longitudinal_repeats", H5_F64, 1, &c->repeats[0]},
                                      {"transverse_repeats", H5_F64, 1, &c->repeats[1]}};
  double tensor[SOLUTE_PECLET_MAX][9];
  const size_t count = (size_t)r->count, dims[3] = {count, 3, 3};
  TRY(write_estimates(file, "/solute/closure", r->count, &c->value, sizeof *c));
  TRY(h5_write_columns(file, "/solute/closure", count, sizeof *c, 9, columns));
  for (int i = 0; i < r->count; i++) memcpy(tensor[i], r->closure[i].tensor, sizeof tensor[i]);
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
  const struct solute_walked *w = r->walk;
  const struct h5_column columns[] = {{"longitudinal_statistics", H5_F64, 1, &w->statistics[0]},
                                      {"transverse_statistics", H5_F64, 1, &w->statistics[1]},
                                      {"longitudinal_asymptotics", H5_F64, 1, &w->asymptotics[0]},
                                      {"transverse_asymptotics", H5_F64, 1, &w->asymptotics[1]},
                                      {"longitudinal_resolution", H5_F64, 1, &w->resolution[0]},
                                      {"transverse_resolution", H5_F64, 1, &w->resolution[1]}};
  TRY(write_estimates(file, "/solute/walk", r->count, &w->value, sizeof *w));
  TRY(h5_write_columns(file, "/solute/walk", (size_t)r->count, sizeof *w, 6, columns));
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
  const size_t count = (size_t)r->count;
  const uint64_t size[3] = {(uint64_t)flow->n[0], (uint64_t)flow->n[1], (uint64_t)flow->n[2]};
  const int mirrored = flow->mirrored;
  const struct h5_number numbers[] = {{"mean_velocity", H5_F64, 3, flow->mean_velocity},
                                      {"spacing", H5_F64, 3, flow->spacing},
                                      {"size", H5_U64, 3, size},
                                      {"dimensions", H5_I32, 1, &flow->dimensions},
                                      {"mirrored", H5_I32, 1, &mirrored},
                                      {"speed", H5_F64, 1, &flow->speed},
                                      {"porosity", H5_F64, 1, &flow->porosity},
                                      {"isolated", H5_F64, 1, &flow->isolated},
                                      {"grain_size", H5_F64, 1, &flow->grain_size},
                                      {"correction", H5_F64, 1, &flow->correction},
                                      {"length", H5_F64, 1, &r->length},
                                      {"diffusion", H5_F64, 1, &r->diffusion},
                                      {"formation_factor", H5_F64, 1, &r->formation},
                                      {"formation_factor_error", H5_F64, 1, &r->formation_error},
                                      {"formation_factor_sample", H5_F64, 1, &r->formation_sample},
                                      {"tortuosity", H5_F64, 1, &r->tortuosity},
                                      {"correlation_length", H5_F64, 2, r->correlation}};
  TRY(h5_make_group(file, "/solute"));
  TRY(h5_write_attribute_text(file, "/solute", "flow", scene->flow_path));
  TRY(h5_write_numbers(file, "/solute", sizeof numbers / sizeof *numbers, numbers));
  TRY(h5_write(file, "/solute/peclet", H5_F64, 1, &count, r->peclet, false));
  TRY(write_estimates(file, "/solute", r->count, r->best, sizeof *r->best));
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
    status = tracks_write(path, flow, &r->record[i], command_line, 2, inputs, hashes);
  }
cleanup:
  h5_close(file);
  return status;
}
