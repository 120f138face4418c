#include "analyze/run_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "common/memory.h"
#include "common/provenance.h"
#include "common/snapshot_file.h"
#include "common/text.h"
#include "common/hdf5_file.h"
#include "common/log.h"

/* The file of the model of a run. */

/* Whether the file is the model of the run. If the run has no hash of 16 digits, or the file cannot
 * be read, it is accepted, and errors are left to its reader. */
static bool is_model_of(const char *path, const char *hash) {
  uint64_t found = 0;
  char text[17];
  if (hash == NULL || strlen(hash) != 16 || strspn(hash, "0") == 16) return true;
  if (hash_file(path, &found) != STATUS_OK) {
    error_clear();
    return true;
  }
  snprintf(text, sizeof text, "%016llx", (unsigned long long)found);
  return strcmp(text, hash) == 0;
}

/* Finds the model that the run `file` names `named`: under that path, in `folder`, or by its last
 * component in `folder`. *model, in new memory, is its path, or "" if it is not found. A file that
 * has changed since the run (by its hash) is not used: *other is then set, with a warning. */
static enum status run_model_find(struct h5_file *file, const char *folder, const char *named,
                                  char **model, bool *other) {
  enum status status = STATUS_OK;
  const char *slash = strrchr(named, '/');
  const char *base = slash == NULL ? named : slash + 1;
  const char *const places[3][2] = {{"", named}, {folder, named}, {folder, base}};
  char *hash = NULL;
  char path[8200] = "";
  bool found = false;
  *other = false;
  if (h5_attribute_exists(file, "/run", "model_hash"))
    status = h5_read_attribute_text(file, "/run", "model_hash", &hash);
  if (status == STATUS_INPUT) { /* a number, written by another program */
    error_clear();
    status = STATUS_OK;
  }
  TRY(status);
  for (int i = 0; i < 3 && !found; i++) {
    snprintf(path, sizeof path, "%s%s", places[i][0], places[i][1]);
    if (places[i][1][0] == '\0' || access(path, R_OK) != 0) continue;
    found = is_model_of(path, hash);
    *other |= !found;
  }
  if (found) *other = false;
  if (*other)
    log_warning("%s: the model file %s is not the one that was run (it was changed or replaced "
                "since): nothing is taken from it",
                h5_path(file), named);
  TRY(memory_allocate(model, sizeof path, 1, "text"));
  if (found) snprintf(*model, sizeof path, "%s", path);
cleanup:
  memory_free(&hash);
  return status;
}

double run_driving(const struct run *run) {
  const double *g = run->driving;
  return sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
}

static enum status read_text_or_empty(struct h5_file *file, const char *object,
                                      const char *attribute, char **text) {
  if (h5_attribute_exists(file, object, attribute))
    return h5_read_attribute_text(file, object, attribute, text);
  return memory_copy_text("", 0, text);
}

static enum status read_numbers(struct h5_file *file, const char *attribute, size_t count,
                                double *values) {
  for (size_t i = 0; i < count; i++) values[i] = NAN;
  if (!h5_attribute_exists(file, "/run", attribute)) return STATUS_OK;
  return h5_read_attribute(file, "/run", attribute, H5_F64, count, values);
}

static enum status need_positive(const struct run *run, const char *attribute, double value) {
  if (isfinite(value) && value > 0.0) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s: attribute %s of /run is missing or not positive; the file is damaged or of "
              "another program: run sphsolve again",
              run->path, attribute);
}

static enum status read_attributes(struct h5_file *file, struct run *run) {
  enum status status = STATUS_OK;
  double size[3], mirrored[3];
  double dimensions;
  TRY(read_text_or_empty(file, "/run", "method", &run->method));
  TRY(read_text_or_empty(file, "/run", "status", &run->status));
  TRY(read_text_or_empty(file, "/run", "wall", &run->wall));
  TRY(read_text_or_empty(file, "/run", "kernel", &run->kernel));
  TRY(read_text_or_empty(file, "/run", "model_path", &run->model_path));
  TRY(read_text_or_empty(file, "/run", "scene_name", &run->name));
  TRY(read_numbers(file, "driving", 3, run->driving));
  TRY(read_numbers(file, "hydraulic_gradient", 1, &run->hydraulic_gradient));
  TRY(read_numbers(file, "density", 1, &run->density));
  TRY(read_numbers(file, "viscosity", 1, &run->viscosity));
  TRY(read_numbers(file, "spacing", 3, run->spacing));
  TRY(read_numbers(file, "origin", 3, run->origin));
  TRY(read_numbers(file, "size", 3, size));
  TRY(read_numbers(file, "mirrored", 3, mirrored));
  for (int d = 0; d < 3; d++) run->mirrored[d] = mirrored[d] > 0.0; /* NAN before version 0.2 */
  TRY(read_numbers(file, "dimensions", 1, &dimensions));
  TRY(read_numbers(file, "bulk_count", 1, &run->bulk_count));
  TRY(read_numbers(file, "fluid_count", 1, &run->fluid_count));
  TRY(read_numbers(file, "darcy_velocity", 3, run->darcy_velocity));
  TRY(read_numbers(file, "k", 1, &run->k));
  TRY(read_numbers(file, "k_solver_error", 1, &run->k_error));
  /* Before version 0.2. */
  if (isnan(run->k_error)) TRY(read_numbers(file, "k_error", 1, &run->k_error));
  TRY(read_numbers(file, "k_low", 1, &run->k_low));
  TRY(read_numbers(file, "k_high", 1, &run->k_high));
  TRY(read_numbers(file, "k_finest", 1, &run->k_finest));
  TRY(read_numbers(file, "k_low_image", 1, &run->k_low_image));
  TRY(read_numbers(file, "k_high_image", 1, &run->k_high_image));
  TRY(read_numbers(file, "reynolds", 1, &run->reynolds));
  TRY(read_numbers(file, "predicted_error", 1, &run->predicted_error));
  run->wall_time = h5_attribute_or_nan(file, "/run/timing", "wall_time");
  TRY(read_numbers(file, "steps", 1, &run->steps));

  TRY(uncertainty_parts_read(file, "/run/error", &run->error));
  TRY(read_text_or_empty(file, "/run/error", "resolution_needs", &run->resolution_needs));

  TRY(need_positive(run, "density", run->density));
  TRY(need_positive(run, "viscosity", run->viscosity));
  for (int d = 0; d < 3; d++) {
    TRY(need_positive(run, "spacing", run->spacing[d]));
    TRY(need_positive(run, "size", size[d]));
    if (size[d] > 1e6 || size[d] != floor(size[d]))
      TRY_FAIL(STATUS_INPUT, "%s: size of /run is no lattice (%g points along an axis)", run->path,
               size[d]);
    run->size[d] = (size_t)size[d];
    if (!isfinite(run->origin[d])) run->origin[d] = 0.0;
    if (!isfinite(run->driving[d])) run->driving[d] = 0.0;
  }
  run->dimensions = dimensions == 2.0 ? 2 : 3;
  const double strength = run_driving(run);
  for (int d = 0; d < 3; d++) run->direction[d] = strength > 0 ? run->driving[d] / strength : 0.0;
  if (isfinite(run->hydraulic_gradient)) run->hydraulic_gradient = fabs(run->hydraulic_gradient);
cleanup:
  return status;
}

static enum status read_column(struct h5_file *file, const struct run *run, const char *name,
                               struct history_column *column) {
  enum status status = STATUS_OK;
  char path[300];
  int rank = 0;
  size_t dims[2] = {0, 1};
  if (snprintf(path, sizeof path, "/history/%s", name) >= (int)sizeof path)
    TRY_FAIL(STATUS_INPUT, "%s: a name in /history is longer than 255 characters", run->path);
  TRY(h5_shape(file, path, 2, &rank, dims));
  if (rank == 1) dims[1] = 1;
  if (rank < 1 || (dims[1] != 1 && dims[1] != 3))
    TRY_FAIL(STATUS_INPUT, "%s: %s is neither [n] nor [n][3]", run->path, path);
  TRY(memory_copy_text(name, strlen(name), &column->name));
  TRY(read_text_or_empty(file, path, "unit", &column->unit));
  TRY(h5_read(file, path, H5_F64, rank, dims, &column->values));
  column->rows = dims[0];
  column->components = rank == 1 ? 1 : (int)dims[1];
cleanup:
  return status;
}

static enum status read_history(struct h5_file *file, struct run *run) {
  enum status status = STATUS_OK;
  size_t count = 0;
  char **names = NULL;
  if (!h5_exists(file, "/history")) return STATUS_OK;
  TRY(h5_list(file, "/history", &count, &names));
  TRY(memory_allocate(&run->columns, count, sizeof *run->columns, "history columns"));
  for (size_t i = 0; i < count; i++) {
    run->column_count = i + 1;
    TRY(read_column(file, run, names[i], &run->columns[i]));
    if (run->columns[i].rows != run->columns[0].rows)
      TRY_FAIL(STATUS_INPUT, "%s: /history/%s has %zu rows, /history/%s %zu: the file is damaged",
               run->path, names[i], run->columns[i].rows, names[0], run->columns[0].rows);
  }
cleanup:
  h5_free_texts(count, &names);
  return status;
}

/* Reads /run/levels, arrays of equal length; files of versions before 0.2 have no estimates. */
static enum status read_levels(struct h5_file *file, struct run *run) {
  enum status status = STATUS_OK;
  struct run_levels *levels = &run->levels;
  struct {
    const char *name;
    double **values;
  } const columns[] = {{"/run/levels/spacing", &levels->spacing},
                       {"/run/levels/k", &levels->k},
                       {"/run/levels/iterations", &levels->iterations},
                       {"/run/levels/seconds", &levels->seconds},
                       {"/run/levels/estimate", &levels->estimate},
                       {"/run/levels/low", &levels->low},
                       {"/run/levels/high", &levels->high}};
  if (!h5_exists(file, "/run/levels")) return STATUS_OK;
  for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) {
    size_t count = 0;
    if (i >= 4 && !h5_exists(file, columns[i].name)) continue;
    TRY(h5_read(file, columns[i].name, H5_F64, 1, &count, columns[i].values));
    if (i > 0 && count != levels->count)
      TRY_FAIL(STATUS_INPUT, "%s: the columns of /run/levels differ in length", run->path);
    levels->count = count;
  }
cleanup:
  return status;
}

static enum status read_snapshots(struct h5_file *file, struct run *run) {
  enum status status = STATUS_OK;
  size_t count = 0;
  if (!h5_exists(file, "/run/snapshots/name")) return STATUS_OK;
  run->flow_hash = flow_hash_read(file, "/run");
  TRY(h5_read_texts(file, "/run/snapshots/name", &run->snapshot_count, &run->snapshot_names));
  TRY(h5_read(file, "/run/snapshots/time", H5_F64, 1, &count, &run->snapshot_times));
  if (count != run->snapshot_count)
    TRY_FAIL(STATUS_INPUT, "%s: /run/snapshots lists %zu names and %zu times", run->path,
             run->snapshot_count, count);
cleanup:
  return status;
}

static enum status read_solid(struct h5_file *file, struct run *run) {
  enum status status = STATUS_OK;
  size_t dims[3];
  if (!h5_exists(file, "/run/solid")) return STATUS_OK;
  TRY(h5_read(file, "/run/solid", H5_U8, 3, dims, &run->solid));
  if (dims[0] != run->size[2] || dims[1] != run->size[1] || dims[2] != run->size[0])
    TRY_FAIL(STATUS_INPUT, "%s: /run/solid does not have the size that /run states", run->path);
cleanup:
  return status;
}

/* Hash of the model as stored by sphsolve (text or number), else a hash of the sites. */
static enum status read_identity(struct h5_file *file, struct run *run) {
  enum status status = STATUS_OK;
  char *text = NULL;
  if (h5_attribute_exists(file, "/run", "model_hash")) {
    status = h5_read_attribute_text(file, "/run", "model_hash", &text);
    if (status == STATUS_OK) {
      if (text[0] != '\0' && strspn(text, "0x") != strlen(text))
        run->identity = hash_bytes(text, strlen(text));
    } else if (status == STATUS_INPUT) {
      error_clear();
      TRY(h5_read_attribute(file, "/run", "model_hash", H5_U64, 1, &run->identity));
    } else {
      goto cleanup;
    }
  }
  if (run->identity == 0) {
    run->identity =
        hash_bytes(run->size, sizeof run->size) ^ hash_bytes(run->spacing, sizeof run->spacing);
    if (run->solid != NULL)
      run->identity ^= hash_bytes(run->solid, run->size[0] * run->size[1] * run->size[2]);
  }
cleanup:
  memory_free(&text);
  return status;
}

static enum status name_by_file(struct run *run) {
  const char *file = run->path + strlen(run->folder);
  const char *ending = strrchr(file, '.');
  memory_free(&run->name);
  return memory_copy_text(file, ending == NULL ? strlen(file) : (size_t)(ending - file),
                          &run->name);
}

static enum status name_run(struct run *run) {
  enum status status = STATUS_OK;
  const char *slash = strrchr(run->path, '/');
  size_t folder = slash == NULL ? 0 : (size_t)(slash - run->path) + 1;
  TRY(memory_copy_text(run->path, folder, &run->folder));
  if (run->name[0] == '\0') TRY(name_by_file(run));
  text_make_plain(run->name);
  TRY(memory_copy_text(run->name, strlen(run->name), &run->title));
cleanup:
  return status;
}

enum status runs_name_apart(struct run *runs, size_t n) {
  enum status status = STATUS_OK;
  bool alike = false;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++) alike |= strcmp(runs[i].name, runs[j].name) == 0;
  for (size_t i = 0; alike && i < n; i++) TRY(name_by_file(&runs[i]));
cleanup:
  return status;
}

enum status run_read(const char *path, struct run *run) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  memset(run, 0, sizeof *run);
  TRY(memory_copy_text(path, strlen(path), &run->path));
  TRY(h5_open(path, &file));
  TRY(provenance_check(file));
  if (!h5_exists(file, "/run")) {
    const char *what = h5_exists(file, "/model")    ? "a model of ct2model"
                       : h5_exists(file, "/VTKHDF") ? "a snapshot"
                                                    : "something else";
    TRY_FAIL(STATUS_INPUT,
             "%s: no run file (it has no group /run; it looks like %s); give the OUT.hdf that "
             "'sphsolve run SCENE.cfg -o OUT' wrote",
             path, what);
  }
  if (h5_exists(file, "/solute"))
    TRY_FAIL(STATUS_INPUT,
             "%s: what a solute does in a flow that another run solved: 'analyze dispersion %s' "
             "shows it, and 'analyze report' beside the flow's own run",
             path, path);
  TRY(read_attributes(file, run));
  TRY(name_run(run));
  TRY(read_history(file, run));
  TRY(read_levels(file, run));
  TRY(read_snapshots(file, run));
  TRY(read_solid(file, run));
  TRY(read_identity(file, run));
  TRY(run_model_find(file, run->folder, run->model_path, &run->model_file, &run->model_other));
cleanup:
  h5_close(file);
  if (status != STATUS_OK) run_free(run);
  return status;
}

bool run_is_companion(const char *path) {
  struct h5_file *file = NULL;
  bool companion = false;
  if (h5_open(path, &file) == STATUS_OK)
    companion =
        !h5_exists(file, "/run") && (h5_attribute_exists(file, "/", "step") ||
                                     h5_exists(file, "/recorder") || h5_exists(file, "/model"));
  else
    error_clear();
  h5_close(file);
  return companion;
}

static bool same_bits(const double *a, const double *b, size_t count) {
  return memcmp(a, b, count * sizeof *a) == 0;
}

bool run_is_copy(const struct run *a, const struct run *b) {
  if (!isfinite(a->wall_time) || a->wall_time != b->wall_time || a->identity != b->identity ||
      a->column_count != b->column_count || !same_bits(&a->k, &b->k, 1) ||
      !same_bits(a->darcy_velocity, b->darcy_velocity, 3) || !same_bits(a->driving, b->driving, 3))
    return false;
  for (size_t i = 0; i < a->column_count; i++) {
    const struct history_column *c = &a->columns[i], *d = &b->columns[i];
    if (c->rows != d->rows || c->components != d->components || strcmp(c->name, d->name) != 0 ||
        !same_bits(c->values, d->values, c->rows * (size_t)c->components))
      return false;
  }
  return true;
}

bool run_has_permeability(const struct run *run) {
  if (strcmp(run->method, "richards") == 0) return false;
  const bool soil = strcmp(run->method, "isph") == 0 || strcmp(run->method, "darcy") == 0;
  return run->hydraulic_gradient > 0.0 && !(soil && isnan(run->k));
}

void run_free(struct run *run) {
  for (size_t i = 0; i < run->column_count; i++) {
    memory_free(&run->columns[i].name);
    memory_free(&run->columns[i].unit);
    memory_free(&run->columns[i].values);
  }
  memory_free(&run->columns);
  memory_free(&run->levels.spacing);
  memory_free(&run->levels.k);
  memory_free(&run->levels.iterations);
  memory_free(&run->levels.seconds);
  memory_free(&run->levels.estimate);
  memory_free(&run->levels.low);
  memory_free(&run->levels.high);
  h5_free_texts(run->snapshot_count, &run->snapshot_names);
  memory_free(&run->snapshot_times);
  memory_free(&run->solid);
  memory_free(&run->path);
  memory_free(&run->folder);
  memory_free(&run->title);
  memory_free(&run->name);
  memory_free(&run->method);
  memory_free(&run->status);
  memory_free(&run->wall);
  memory_free(&run->kernel);
  memory_free(&run->model_path);
  memory_free(&run->model_file);
  memory_free(&run->resolution_needs);
  memset(run, 0, sizeof *run);
}

const struct history_column *run_column(const struct run *run, const char *name, int components) {
  for (size_t i = 0; i < run->column_count; i++)
    if (run->columns[i].components == components && strcmp(run->columns[i].name, name) == 0)
      return &run->columns[i];
  return NULL;
}

enum status run_darcy_series(const struct run *run, size_t *rows, double **times, double **values) {
  enum status status = STATUS_OK;
  const struct history_column *time = run_column(run, "time", 1);
  const struct history_column *velocity = run_column(run, "darcy_velocity", 3);
  *rows = 0;
  *times = *values = NULL;
  if (time == NULL || velocity == NULL || time->rows == 0)
    TRY_FAIL(STATUS_INPUT,
             "%s: /history has no rows of time and darcy_velocity; the run ended before its first "
             "history row: run sphsolve longer",
             run->path);
  double direction[3] = {run->direction[0], run->direction[1], run->direction[2]};
  if (direction[0] == 0.0 && direction[1] == 0.0 && direction[2] == 0.0) {
    const double *last = &velocity->values[3 * (velocity->rows - 1)];
    int axis = 2;
    for (int d = 0; d < 3; d++)
      if (fabs(last[d]) > fabs(last[axis])) axis = d;
    direction[axis] = last[axis] < 0 ? -1.0 : 1.0;
  }
  TRY(memory_allocate(times, time->rows, sizeof **times, "history"));
  TRY(memory_allocate(values, time->rows, sizeof **values, "history"));
  for (size_t i = 0; i < time->rows; i++) {
    const double *v = &velocity->values[3 * i];
    (*times)[i] = time->values[i];
    (*values)[i] = v[0] * direction[0] + v[1] * direction[1] + v[2] * direction[2];
    if (!isfinite((*times)[i]) || !isfinite((*values)[i]))
      TRY_FAIL(STATUS_INPUT,
               "%s: row %zu of /history is not finite: the run blew up; lower wcsph.dt or raise "
               "wcsph.sound_speed and run again",
               run->path, i);
  }
  *rows = time->rows;
cleanup:
  if (status != STATUS_OK) {
    memory_free(times);
    memory_free(values);
  }
  return status;
}

enum status run_last_snapshot(const struct run *run, struct particles *particles) {
  enum status status = STATUS_OK;
  struct snapshot snapshot = {0};
  char path[8192];
  memset(particles, 0, sizeof *particles);
  if (run->snapshot_count == 0)
    TRY_FAIL(STATUS_INPUT,
             "%s: the run lists no snapshots, so there are no particles to look at; run sphsolve "
             "again to the end (it writes at least the last snapshot)",
             run->path);
  const char *name = run->snapshot_names[run->snapshot_count - 1];
  if (snprintf(path, sizeof path, "%s%s", run->folder, name) >= (int)sizeof path)
    TRY_FAIL(STATUS_INPUT, "%s: the name of a snapshot is too long", run->path);
  if (access(path, R_OK) != 0)
    TRY_FAIL(STATUS_INPUT, "%s: %s; the files of a run stay together: copy it there", path,
             strerror(errno));
  TRY(snapshot_open(path, &snapshot));
  TRY(flow_hash_check(run->path, run->flow_hash, path, snapshot.file));
  if (snapshot.count == 0) TRY_FAIL(STATUS_INPUT, "%s: the snapshot holds no particles", path);
  TRY(snapshot_read(&snapshot, "velocity", 3, &particles->velocity));
  if (h5_exists(snapshot.file, "/VTKHDF/PointData/density"))
    TRY(snapshot_read(&snapshot, "density", 1, &particles->density));
  if (h5_exists(snapshot.file, "/VTKHDF/PointData/pressure"))
    TRY(snapshot_read(&snapshot, "pressure", 1, &particles->pressure));
  if (h5_exists(snapshot.file, "/VTKHDF/PointData/micro_porosity"))
    TRY(snapshot_read(&snapshot, "micro_porosity", 1, &particles->micro_porosity));
  for (size_t i = 0; i < 3 * snapshot.count; i++)
    if (!isfinite(particles->velocity[i]) || !isfinite(snapshot.points[i]))
      TRY_FAIL(STATUS_INPUT, "%s: particle %zu has a position or velocity that is not finite", path,
               i / 3);
  particles->time = snapshot.time;
  particles->count = snapshot.count;
  particles->points = snapshot.points;
  snapshot.points = NULL;
cleanup:
  snapshot_close(&snapshot);
  if (status != STATUS_OK) {
    error_context(status, "%s", run->path);
    particles_free(particles);
  }
  return status;
}

void particles_free(struct particles *particles) {
  memory_free(&particles->points);
  memory_free(&particles->velocity);
  memory_free(&particles->density);
  memory_free(&particles->pressure);
  memory_free(&particles->micro_porosity);
  particles->count = 0;
}

static bool comparable(const struct run *a, const struct run *b) {
  double aligned = 0.0;
  for (int d = 0; d < 3; d++) aligned += a->direction[d] * b->direction[d];
  return a->identity == b->identity && fabs(a->spacing[0] / b->spacing[0] - 1.0) < 1e-6 &&
         fabs(a->density - b->density) < 1e-9 * a->density &&
         fabs(a->viscosity - b->viscosity) < 1e-9 * a->viscosity &&
         strcmp(a->method, b->method) == 0 && strcmp(a->wall, b->wall) == 0 && aligned > 0.999;
}

size_t runs_group(const struct run *runs, size_t n, size_t *group) {
  size_t groups = 0;
  for (size_t i = 0; i < n; i++) {
    size_t first = 0;
    while (first < i && !comparable(&runs[first], &runs[i])) first++;
    group[i] = first < i ? group[first] : groups++;
  }
  return groups;
}

void run_group_name(const struct run *run, char *text, size_t size) {
  const char *base = run->name;
  size_t length = strlen(base);
  if (run->model_path[0] != '\0') {
    const char *slash = strrchr(run->model_path, '/');
    base = slash == NULL ? run->model_path : slash + 1;
    const char *ending = strrchr(base, '.');
    length = ending == NULL ? strlen(base) : (size_t)(ending - base);
  }
  snprintf(text, size, "%.*s (%s%s%s%s)", (int)(length > 200 ? 200 : length), base,
           run->method[0] ? run->method : "unknown method", run->wall[0] ? ", " : "", run->wall,
           run->wall[0] ? " walls" : "");
}
