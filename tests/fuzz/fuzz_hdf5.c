/* libFuzzer: any bytes as a model, a run and a snapshot. HDF5 1.10 itself crashes on some; the
 * trial in a process of its own (common/hdf5_probe.c) has to find them first. */
#include "common/model_file.h"
#include "fuzz_reads.h"

/* Each file is tried once, not by each of the readers: the sanitizer makes a new process slow.
 * Where the library hangs it is waited for a second, not for 20. */
#define PROBE_SECONDS 1
#define h5_try h5_try_anew
#include "common/hdf5_probe.c"
#undef h5_try
enum status h5_try(const char *path);
static enum status tried;
enum status h5_try(const char *path) {
  (void)path;
  return tried;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *path = fuzz_file(".hdf", data, size);
  struct h5_file *file = NULL;
  struct voxel_model model;
  tried = h5_try_anew(path);
  if (h5_open(path, &file) == STATUS_OK) {
    h5_close(file);
    if (model_read(path, &model) == STATUS_OK) model_free(&model);
    error_clear();
    fuzz_read_run(path);
    fuzz_read_snapshot(path);
  }
  return fuzz_end(path, 0);
}
