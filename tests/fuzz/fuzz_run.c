/* libFuzzer: any bytes as a run file and as a snapshot, as analyze reads them. */
#include <math.h>

#include "analyze/run_file.h"
#include "common/snapshot_file.h"
#include "fuzz_hdf5.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *path = fuzz_file(".hdf", data, size);
  struct run run;
  struct snapshot snapshot;
  struct particles particles;
  double *times = NULL, *values = NULL, *velocity = NULL;
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
  if (snapshot_open(path, &snapshot) == STATUS_OK) {
    if (snapshot_read(&snapshot, "velocity", 3, &velocity) == STATUS_OK) memory_free(&velocity);
    snapshot_close(&snapshot);
  }
  return fuzz_end(path, 0);
}
