/* State of the recorder, shared by recorder.c (during the run) and recorder_file.c (the file at its
 * end). */
#ifndef TOSUI_SPHSOLVE_OUTPUT_RECORDER_STATE_H
#define TOSUI_SPHSOLVE_OUTPUT_RECORDER_STATE_H

#include <string.h>

#include "common/log.h"
#include "sphsolve/output/history_file.h"
#include "sphsolve/output/recorder.h"

#define COLUMN_MAX 1024
#define NAMED_MAX 96

struct column {
  char name[48], unit[24];
  int components, first; /* position of its first value in a row */
};

struct named_value {
  char name[48];
  double value;
};

struct recorder {
  char prefix[3900];
  const struct scene *scene;
  const struct plan *plan;
  const struct lattice *lattice;
  char *command_line;
  bool resume;

  size_t column_count;
  struct column columns[COLUMN_MAX];
  int width; /* values per row */
  size_t row_count, row_capacity;
  double *rows;                /* [row_count][width] */
  struct history_file history; /* file of the rows, opened with the first row */

  size_t snapshot_count, snapshot_capacity;
  char **snapshot_names;
  double *snapshot_times;
  double next_snapshot, snapshot_interval; /* s; interval NAN: only the last one */
  /* Hash of the velocities of the last snapshot, and of the image; 0: unknown. */
  uint64_t flow_hash;

  size_t timing_count, fact_count, measured_count;
  struct named_value timings[NAMED_MAX], facts[NAMED_MAX], measured[NAMED_MAX];
  struct step_log step_log;
  char checkpoint_name[4096];

  struct progress progress;
  double last_checkpoint; /* time on the monotonic clock, s */
};

/* Position of a column's first value in a row; -1: there is no such column. */
static inline int recorder_first_of(const struct recorder *recorder, const char *name) {
  for (size_t c = 0; c < recorder->column_count; c++)
    if (!strcmp(recorder->columns[c].name, name)) return recorder->columns[c].first;
  return -1;
}

#endif
