#include "sphsolve/output/step_log.h"

#include <stdio.h>
#include <string.h>

#include "common/hdf5_table.h"
#include "common/memory.h"

void step_log_limit(struct step_log *log, const char *effect) {
  size_t i = 0;
  while (i < log->limit_count && strcmp(log->limit_names[i], effect) != 0) i++;
  if (i == STEP_LIMITS_MAX) return;
  if (i == log->limit_count)
    snprintf(log->limit_names[log->limit_count++], sizeof *log->limit_names, "%s", effect);
  log->limit_steps[i]++;
}

enum status step_log_back(struct step_log *log, const struct step_back *back) {
  enum status status = STATUS_OK;
  if (log->back_count == log->back_capacity) {
    size_t capacity = log->back_capacity + 8;
    TRY(memory_resize(&log->backs, capacity, sizeof *log->backs, "the record of steps back"));
    log->back_capacity = capacity;
  }
  log->backs[log->back_count++] = *back;
cleanup:
  return status;
}

static const char *path_of(const char *group, const char *name, char path[96]) {
  snprintf(path, 96, "%s/%s", group, name);
  return path;
}

enum status step_log_write(const struct step_log *log, struct h5_file *file, const char *group) {
  enum status status = STATUS_OK;
  const struct h5_column name = {"limits/name", 0, H5_TEXT, log->limit_names};
  char path[96];
  if (log->limit_count > 0) {
    TRY(h5_write_columns(file, group, log->limit_count, sizeof *log->limit_names, 1, &name));
    TRY(h5_write(file, path_of(group, "limits/steps", path), H5_F64, 1, &log->limit_count,
                 log->limit_steps, false));
  }
  if (log->back_count > 0) {
    const struct step_back *backs = log->backs;
    const struct h5_column back[] = {{"watchdog/cause", 0, H5_TEXT, backs->cause},
                                     {"watchdog/time", H5_F64, 1, &backs->time},
                                     {"watchdog/back_to", H5_F64, 1, &backs->back_to},
                                     {"watchdog/dt", H5_F64, 1, &backs->dt}};
    TRY(h5_write_columns(file, group, log->back_count, sizeof *backs, 4, back));
  }
cleanup:
  return status;
}

enum status step_log_read(struct step_log *log, struct h5_file *file, const char *group) {
  enum status status = STATUS_OK;
  char path[96], **names = NULL, **causes = NULL;
  double *numbers[3] = {NULL};
  size_t count = 0, cause_count = 0, dims[2];
  step_log_free(log);
  if (h5_exists(file, path_of(group, "limits/name", path))) {
    TRY(h5_read_texts(file, path, &count, &names));
    TRY(h5_read(file, path_of(group, "limits/steps", path), H5_F64, 1, dims, &numbers[0]));
    if (count > STEP_LIMITS_MAX || dims[0] != count)
      TRY_FAIL(STATUS_INPUT, "%s: %s is damaged", h5_path(file), path);
    for (size_t i = 0; i < count; i++) {
      snprintf(log->limit_names[i], sizeof *log->limit_names, "%s", names[i]);
      log->limit_steps[i] = numbers[0][i];
    }
    log->limit_count = count;
    memory_free(&numbers[0]);
  }
  if (h5_exists(file, path_of(group, "watchdog/cause", path))) {
    static const char *const parts[] = {"watchdog/time", "watchdog/back_to", "watchdog/dt"};
    TRY(h5_read_texts(file, path, &cause_count, &causes));
    for (int k = 0; k < 3; k++) {
      TRY(h5_read(file, path_of(group, parts[k], path), H5_F64, 1, dims, &numbers[k]));
      if (dims[0] != cause_count) TRY_FAIL(STATUS_INPUT, "%s: %s is damaged", h5_path(file), path);
    }
    for (size_t i = 0; i < cause_count; i++) {
      struct step_back back = {numbers[0][i], numbers[1][i], numbers[2][i], ""};
      snprintf(back.cause, sizeof back.cause, "%s", causes[i]);
      TRY(step_log_back(log, &back));
    }
  }
cleanup:
  h5_free_texts(count, &names);
  h5_free_texts(cause_count, &causes);
  for (int k = 0; k < 3; k++) memory_free(&numbers[k]);
  return status;
}

void step_log_free(struct step_log *log) {
  memory_free(&log->backs);
  memset(log, 0, sizeof *log);
}
