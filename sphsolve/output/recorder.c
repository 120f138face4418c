#include "sphsolve/output/recorder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/provenance.h"
#include "common/ranks.h"
#include "sphsolve/output/checkpoint_file.h"
#include "sphsolve/output/image.h"
#include "sphsolve/output/recorder_state.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/scene/scene_compare.h"

/* The columns of every method, from the members of a row. */
static const struct {
  const char *name, *unit;
  int components;
  size_t offset;
} base[] = {
#define COLUMN(member, unit, components)                                                           \
  { #member, unit, components, offsetof(struct history_row, member) }
    COLUMN(time, "s", 1),
    COLUMN(step, "1", 1),
    COLUMN(dt, "s", 1),
    COLUMN(darcy_velocity, "m/s", 3),
    COLUMN(density_max, "kg/m^3", 1),
    COLUMN(density_mean, "kg/m^3", 1),
    COLUMN(kinetic_energy, "J", 1),
    COLUMN(momentum, "kg m/s", 3),
    COLUMN(mass, "kg", 1),
    COLUMN(reynolds, "1", 1),
#undef COLUMN
};
enum { BASE_COLUMNS = sizeof base / sizeof *base };

static enum status add_column(struct recorder *recorder, const char *name, const char *unit,
                              int components) {
  if (recorder->column_count == COLUMN_MAX)
    return FAIL(STATUS_INPUT, "the history has more than %d columns; fewer gauges and planes",
                COLUMN_MAX);
  struct column *column = &recorder->columns[recorder->column_count++];
  snprintf(column->name, sizeof column->name, "%s", name);
  snprintf(column->unit, sizeof column->unit, "%s", unit);
  column->components = components;
  column->first = recorder->width;
  recorder->width += components;
  return STATUS_OK;
}

enum status recorder_add_column(struct recorder *recorder, const char *name, const char *unit,
                                int components) {
  for (size_t i = 0; i < recorder->column_count; i++)
    if (!strcmp(recorder->columns[i].name, name))
      return FAIL(STATUS_INPUT,
                  "two columns of the history are called '%s'; rename a gauge or plane", name);
  return add_column(recorder, name, unit, components);
}

/* Refuses to overwrite inputs: "-o dense" with model.file = "dense.hdf" would replace the model by
 * its run. */
static enum status refuse_overwriting(const struct recorder *recorder) {
  enum status status = STATUS_OK;
  static const char *const endings[] = {".hdf",         ".ckpt.hdf",   ".ckpt.1.hdf",
                                        ".history.csv", ".hdf.series", "-image.hdf"};
  char path[4096];
  output_protect(recorder->scene->path);
  if (*recorder->scene->model_path) output_protect(recorder->scene->model_path);
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
    snprintf(path, sizeof path, "%s%s", recorder->prefix, endings[i]);
    /* A damaged checkpoint may be read with --resume, which reports the damage. */
    if (recorder->resume && strstr(endings[i], ".ckpt") != NULL) continue;
    TRY(output_allow_kind(path, "/model", "a model"));
  }
cleanup:
  return ranks_agree(status);
}

/* As the scene says; without that six times of water that moves through space, begin and end among
 * them, which is what a report shows, and of other flows the end alone. */
static double snapshot_interval(const struct scene *scene, const struct plan *plan) {
  const struct method *method = plan->context.method;
  const bool moves = method != NULL && method->marches && !method->resolves_pores;
  if (!isnan(scene->output_interval) || !moves || !isfinite(scene->end_time))
    return scene->output_interval;
  return scene->end_time / 5;
}

enum status recorder_open(const char *prefix, const struct scene *scene, const struct plan *plan,
                          const struct lattice *lattice, const char *command_line, bool resume,
                          struct recorder **result) {
  enum status status = STATUS_OK;
  struct recorder *recorder = NULL;
  TRY(memory_allocate(&recorder, 1, sizeof *recorder, "the run record"));
  if (strlen(prefix) >= sizeof recorder->prefix || !*prefix)
    TRY_FAIL(STATUS_USAGE, "-o '%s': a name for the output files is wanted", prefix);
  snprintf(recorder->prefix, sizeof recorder->prefix, "%s", prefix);
  recorder->scene = scene;
  recorder->plan = plan;
  recorder->lattice = lattice;
  recorder->resume = resume;
  TRY(memory_copy_text(command_line, strlen(command_line), &recorder->command_line));
  for (size_t i = 0; i < BASE_COLUMNS; i++)
    TRY(add_column(recorder, base[i].name, base[i].unit, base[i].components));
  recorder->snapshot_interval = snapshot_interval(scene, plan);
  recorder->next_snapshot = isnan(recorder->snapshot_interval) ? INFINITY : 0;
  recorder->last_checkpoint = clock_seconds();
  /* Unwritable outputs are reported before the computation. */
  TRY(refuse_overwriting(recorder));
  interrupt_start("what was done is kept, and --resume goes on from it; once more ends at once");
  progress_start(&recorder->progress, "sphsolve", NULL, 100);
  *result = recorder;
cleanup:
  if (status != STATUS_OK) recorder_close(recorder);
  return status;
}

void recorder_close(struct recorder *recorder) {
  if (recorder == NULL) return;
  progress_end(&recorder->progress);
  h5_free_texts(recorder->snapshot_count, &recorder->snapshot_names);
  memory_free(&recorder->snapshot_times);
  history_file_close(&recorder->history, false);
  MEMORY_FREE(&recorder->rows, &recorder->command_line);
  step_log_free(&recorder->step_log);
  memory_free(&recorder);
}

static uint64_t scene_hash(const struct recorder *recorder) {
  return hash_bytes(recorder->scene->text, strlen(recorder->scene->text));
}

static enum status reserve_row(struct recorder *recorder, size_t count) {
  if (count <= recorder->row_capacity) return STATUS_OK;
  size_t capacity = recorder->row_capacity ? 2 * recorder->row_capacity : 256;
  if (capacity < count) capacity = count;
  enum status status = memory_resize(&recorder->rows, capacity,
                                     (size_t)recorder->width * sizeof(double), "the history");
  if (status == STATUS_OK) recorder->row_capacity = capacity;
  return status;
}

/* Header: the names of the columns, and at last the identity of scene and model. */
static enum status open_history(struct recorder *recorder) {
  enum status status = STATUS_OK;
  char path[4096], *header = NULL;
  size_t n = 0, room = (size_t)recorder->width * sizeof recorder->columns[0].name + 64;
  TRY(memory_allocate(&header, room, 1, "the history"));
  for (size_t c = 0; c < recorder->column_count; c++)
    for (int i = 0; i < recorder->columns[c].components; i++) {
      static const char *const axis[] = {"_x,", "_y,", "_z,"};
      n += (size_t)snprintf(header + n, room - n, "%s%s", recorder->columns[c].name,
                            recorder->columns[c].components > 1 ? axis[i % 3] : ",");
    }
  snprintf(header + n, room - n, "xxh3 (scene %016llx)",
           (unsigned long long)(scene_hash(recorder) ^ recorder->lattice->model.hash));
  snprintf(path, sizeof path, "%s.history.csv", recorder->prefix);
  TRY(history_file_open(&recorder->history, path, header, recorder->width, recorder->row_count,
                        recorder->rows, recorder->resume));
cleanup:
  memory_free(&header);
  return status;
}

size_t recorder_extra_width(const struct recorder *recorder) {
  int n = 0;
  for (size_t i = 0; i < BASE_COLUMNS; i++) n += base[i].components;
  return (size_t)(recorder->width - n);
}

enum status recorder_row(struct recorder *recorder, const struct history_row *row,
                         const double *extra) {
  enum status status = STATUS_OK;
  if (recorder->history.file == 0 && ranks_own() == 0) TRY(open_history(recorder));
  TRY(reserve_row(recorder, recorder->row_count + 1));
  double *to = recorder->rows + recorder->row_count++ * (size_t)recorder->width;
  int n = 0;
  for (size_t i = 0; i < BASE_COLUMNS; n += base[i++].components) {
    const char *member = (const char *)row + base[i].offset;
    if (base[i].offset == offsetof(struct history_row, step))
      to[n] = (double)row->step;
    else
      memcpy(to + n, member, (size_t)base[i].components * sizeof *to);
  }
  if (recorder->width > n) memcpy(to + n, extra, (size_t)(recorder->width - n) * sizeof *to);
  if (ranks_own() == 0) TRY(history_file_row(&recorder->history, recorder->row_count - 1, to));
cleanup:
  return status;
}

double recorder_row_interval(const struct recorder *recorder) {
  return recorder->scene->history_interval;
}
double recorder_next_snapshot(const struct recorder *recorder) {
  return recorder->next_snapshot;
}

static bool field_wanted(const struct scene *scene, const char *name) {
  if (scene->output_field_count == 0 || !strcmp(name, "velocity")) return true;
  for (size_t i = 0; i < scene->output_field_count; i++)
    if (!strcmp(scene->output_fields[i], name)) return true;
  return false;
}

static enum status note_snapshot(struct recorder *recorder, const char *name, double time) {
  enum status status = STATUS_OK;
  if (recorder->snapshot_count == recorder->snapshot_capacity) {
    size_t capacity = recorder->snapshot_capacity ? 2 * recorder->snapshot_capacity : 64;
    TRY(memory_resize(&recorder->snapshot_names, capacity, sizeof(char *),
                      "the list of snapshots"));
    TRY(memory_resize(&recorder->snapshot_times, capacity, sizeof(double),
                      "the list of snapshots"));
    recorder->snapshot_capacity = capacity;
  }
  char *copy;
  TRY(memory_copy_text(name, strlen(name), &copy));
  recorder->snapshot_names[recorder->snapshot_count] = copy;
  recorder->snapshot_times[recorder->snapshot_count++] = time;
cleanup:
  return status;
}

/* Hash of the velocities; 0 if they are not all in memory: written piecewise, or distributed over
 * ranks. */
static uint64_t flow_hash(const float *velocity, size_t count) {
  return velocity == NULL || ranks_count() > 1 ? 0
                                               : hash_bytes(velocity, 3 * count * sizeof *velocity);
}

enum status recorder_snapshot(struct recorder *recorder, double time, int64_t step, size_t count,
                              const struct snapshot_field *points, size_t field_count,
                              const struct snapshot_field *fields) {
  enum status status = STATUS_OK;
  char path[4096];
  struct snapshot_field wanted[32];
  size_t n = 0;
  for (size_t i = 0; i < field_count && n < 32; i++) {
    if (field_wanted(recorder->scene, fields[i].name)) wanted[n++] = fields[i];
    if (!strcmp(fields[i].name, "velocity") && fields[i].type == H5_F32)
      recorder->flow_hash = flow_hash(fields[i].data, count);
  }
  snprintf(path, sizeof path, "%s-%04zu.hdf", recorder->prefix, recorder->snapshot_count);
  TRY(ranks_agree(output_allow(path)));
  TRY(snapshot_write(path, time, step, recorder->flow_hash, count, points, n, wanted));
  const char *slash = strrchr(path, '/');
  TRY(note_snapshot(recorder, slash != NULL ? slash + 1 : path, time));
  snprintf(path, sizeof path, "%s.hdf.series", recorder->prefix);
  TRY(series_write(path, recorder->snapshot_count, recorder->snapshot_names,
                   recorder->snapshot_times));
  double interval = recorder->snapshot_interval;
  if (!isnan(interval))
    while (recorder->next_snapshot <= time * (1 + 1e-12)) recorder->next_snapshot += interval;
cleanup:
  return status;
}

enum status recorder_image(struct recorder *recorder, const struct lattice *lattice, double time,
                           int64_t step, size_t count, const uint64_t *site, const float *velocity,
                           const float *pressure) {
  if (ranks_count() > 1 || !recorder->scene->image) return STATUS_OK;
  return image_write(recorder->prefix, lattice, recorder->scene->fluid.viscosity, time, step,
                     flow_hash(velocity, count), count, site, velocity, pressure);
}

enum status recorder_go_back(struct recorder *recorder, double time) {
  double after = time * (1 + 1e-12), interval = recorder->snapshot_interval;
  while (recorder->row_count > 0 &&
         recorder->rows[(recorder->row_count - 1) * (size_t)recorder->width] > after)
    recorder->row_count--;
  while (recorder->snapshot_count > 0 &&
         recorder->snapshot_times[recorder->snapshot_count - 1] > after)
    memory_free(&recorder->snapshot_names[--recorder->snapshot_count]);
  while (!isnan(interval) && recorder->next_snapshot - interval > after)
    recorder->next_snapshot -= interval;
  return history_file_truncate(&recorder->history, recorder->row_count);
}

enum status recorder_drop_row(struct recorder *recorder) {
  recorder->row_count--;
  return history_file_truncate(&recorder->history, recorder->row_count);
}

struct step_log *recorder_step_log(struct recorder *recorder) {
  return &recorder->step_log;
}

const char *recorder_checkpoint_name(struct recorder *recorder) {
  snprintf(recorder->checkpoint_name, sizeof recorder->checkpoint_name, "%s.ckpt.hdf",
           recorder->prefix);
  return recorder->checkpoint_name;
}

void recorder_progress(struct recorder *recorder, double done, const char *note) {
  progress_update(&recorder->progress, 100 * fmin(fmax(done, 0), 1), note);
}

bool recorder_interrupted(const struct recorder *recorder) {
  (void)recorder;
  return ranks_any(interrupt_requested());
}

bool recorder_checkpoint_due(const struct recorder *recorder) {
  double interval = recorder->scene->checkpoint_interval;
  return ranks_any(interrupt_requested() ||
                   (!isnan(interval) && clock_seconds() - recorder->last_checkpoint >= interval));
}

enum status recorder_checkpoint_begin(struct recorder *recorder, struct h5_file **file) {
  return checkpoint_create(recorder->prefix, file);
}

enum status recorder_checkpoint_commit(struct recorder *recorder, struct h5_file *file) {
  enum status status = STATUS_OK;
  size_t shape[2] = {recorder->row_count, (size_t)recorder->width};
  uint64_t hash = scene_hash(recorder);
  char *settled = NULL;
  TRY(scene_describe(recorder->scene, &settled));
  TRY(h5_write_text(file, "/recorder/settings", settled));
  TRY(h5_write(file, "/recorder/rows", H5_F64, 2, shape, recorder->rows, true));
  TRY(h5_write_texts(file, "/recorder/snapshot_names", recorder->snapshot_count,
                     (const char *const *)recorder->snapshot_names));
  TRY(h5_write(file, "/recorder/snapshot_times", H5_F64, 1, &recorder->snapshot_count,
               recorder->snapshot_times, false));
  TRY(h5_write_attribute(file, "/recorder", "next_snapshot", H5_F64, 1, &recorder->next_snapshot));
  TRY(h5_write_attribute(file, "/recorder", "scene_hash", H5_U64, 1, &hash));
  TRY(h5_write_attribute(file, "/recorder", "model_hash", H5_U64, 1,
                         &recorder->lattice->model.hash));
  TRY(step_log_write(&recorder->step_log, file, "/recorder"));
  status = checkpoint_commit(recorder->prefix, file);
  file = NULL;
  recorder->last_checkpoint = clock_seconds();
cleanup:
  free(settled);
  h5_close(file);
  return status;
}

/* For a scene whose text differs from that of the checkpoint: logs or refuses settings that
 * differ. */
static enum status compare_settings(const struct recorder *recorder, struct h5_file *file) {
  enum status status = STATUS_OK;
  char *then = NULL, *now = NULL;
  if (!h5_exists(file, "/recorder/settings")) {
    log_warning("%s was written by a scene with another text; going on with the new one",
                h5_path(file));
    return STATUS_OK;
  }
  TRY(h5_read_text(file, "/recorder/settings", &then));
  TRY(scene_describe(recorder->scene, &now));
  TRY(scene_compare(then, now, h5_path(file)));
cleanup:
  memory_free(&then);
  free(now);
  return status;
}

/* Refuses to replace a finished run by a new one from the start, if --resume asked to continue
 * it. */
static enum status refuse_finished(const char *prefix) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  char path[4096], *ended = NULL;
  snprintf(path, sizeof path, "%s.hdf", prefix);
  if (access(path, F_OK) != 0) return STATUS_OK;
  if (h5_open_output(path, &file) != STATUS_OK ||
      h5_read_attribute_text(file, "/run", "status", &ended) != STATUS_OK) {
    error_clear(); /* not a run record: checked elsewhere */
    goto cleanup;
  }
  if (!strcmp(ended, "end_time"))
    TRY_FAIL(STATUS_USAGE,
             "%s: this run is finished and left no checkpoint to go on from; leave out --resume to "
             "run it anew, with checkpoint.interval = \"10 min\" if it may be given more",
             path);
cleanup:
  memory_free(&ended);
  h5_close(file);
  return status;
}

enum status recorder_resume(struct recorder *recorder, struct h5_file **file) {
  enum status status = STATUS_OK;
  size_t shape[2], count = 0, times = 0;
  char **names = NULL;
  double *snapshot_times = NULL;
  uint64_t hash, model_hash;
  *file = NULL;
  if (!recorder->resume) return STATUS_OK;
  TRY(checkpoint_open(recorder->prefix, file));
  if (*file == NULL) {
    TRY(refuse_finished(recorder->prefix));
    log_info("no checkpoint %s.ckpt.hdf yet: starting anew", recorder->prefix);
    return STATUS_OK;
  }
  TRY(h5_read_attribute(*file, "/recorder", "scene_hash", H5_U64, 1, &hash));
  TRY(h5_read_attribute(*file, "/recorder", "model_hash", H5_U64, 1, &model_hash));
  if (model_hash != recorder->lattice->model.hash)
    TRY_FAIL(STATUS_INPUT, "%s: belongs to another model; remove it to start anew", h5_path(*file));
  if (hash != scene_hash(recorder)) TRY(compare_settings(recorder, *file));
  memory_free(&recorder->rows);
  TRY(h5_read(*file, "/recorder/rows", H5_F64, 2, shape, &recorder->rows));
  if (shape[1] != (size_t)recorder->width)
    TRY_FAIL(STATUS_INPUT,
             "%s: was written by this scene as it stood before: another method, or other gauges or "
             "planes; take these changes back, or leave out --resume to start anew",
             h5_path(*file));
  recorder->row_count = recorder->row_capacity = shape[0];
  TRY(h5_read_texts(*file, "/recorder/snapshot_names", &count, &names));
  TRY(h5_read(*file, "/recorder/snapshot_times", H5_F64, 1, &times, &snapshot_times));
  if (times != count) TRY_FAIL(STATUS_INPUT, "%s: is damaged", h5_path(*file));
  for (size_t i = 0; i < count; i++) TRY(note_snapshot(recorder, names[i], snapshot_times[i]));
  TRY(h5_read_attribute(*file, "/recorder", "next_snapshot", H5_F64, 1, &recorder->next_snapshot));
  TRY(step_log_read(&recorder->step_log, *file, "/recorder"));
cleanup:
  h5_free_texts(count, &names);
  memory_free(&snapshot_times);
  if (status != STATUS_OK) {
    h5_close(*file);
    *file = NULL;
  }
  return status;
}

static void set_named(struct named_value *values, size_t *count, const char *name, double value,
                      bool add) {
  for (size_t i = 0; i < *count; i++)
    if (!strcmp(values[i].name, name)) {
      values[i].value = add ? values[i].value + value : value;
      return;
    }
  if (*count == NAMED_MAX) return;
  snprintf(values[*count].name, sizeof values[*count].name, "%s", name);
  values[(*count)++].value = value;
}

void recorder_add_time(struct recorder *recorder, const char *name, double seconds) {
  set_named(recorder->timings, &recorder->timing_count, name, seconds, true);
}
void recorder_set_fact(struct recorder *recorder, const char *name, double value) {
  set_named(recorder->facts, &recorder->fact_count, name, value, false);
}
void recorder_set_measured(struct recorder *recorder, const char *name, double value) {
  set_named(recorder->measured, &recorder->measured_count, name, value, false);
}
