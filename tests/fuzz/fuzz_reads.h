/* A file read in all the ways that analyze reads one. */
#ifndef TOSUI_FUZZ_READS_H
#define TOSUI_FUZZ_READS_H

#include "analyze/run_file.h"
#include "common/snapshot_file.h"
#include "fuzz_input.h"

static inline void fuzz_read_run(const char *path) {
  struct run run;
  struct particles particles;
  double *times = NULL, *values = NULL;
  size_t rows;
  if (run_read(path, &run) == STATUS_OK) {
    if (run_darcy_series(&run, &rows, &times, &values) == STATUS_OK) {
      memory_free(&times);
      memory_free(&values);
    }
    error_clear();
    if (run_last_snapshot(&run, &particles) == STATUS_OK) particles_free(&particles);
    run_free(&run);
  }
  error_clear();
  (void)run_is_companion(path);
  error_clear();
}

static inline void fuzz_read_snapshot(const char *path) {
  struct snapshot snapshot;
  double *velocity = NULL;
  if (snapshot_open(path, &snapshot) == STATUS_OK) {
    if (snapshot_read(&snapshot, "velocity", 3, &velocity) == STATUS_OK) memory_free(&velocity);
    snapshot_close(&snapshot);
  }
  error_clear();
}

#endif
