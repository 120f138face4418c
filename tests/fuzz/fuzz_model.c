/* libFuzzer: any bytes as a model file. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "common/error.h"
#include "common/memory.h"
#include "common/model_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
const char *__lsan_default_suppressions(void);

/* HDF5 1.10 loses parts of its tables when it gives up on a damaged file; not ours to free. */
const char *__lsan_default_suppressions(void) { return "leak:libhdf5\n"; }

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static char path[64];
  if (!*path) snprintf(path, sizeof path, "/dev/shm/tosui-fuzz-model-%d", (int)getpid());
  memory_set_limit((size_t)1 << 28);
  FILE *file = fopen(path, "wb");
  if (file == NULL) abort();
  fwrite(data, 1, size, file);
  fclose(file);
  struct voxel_model model;
  if (model_read(path, &model) == STATUS_OK) model_free(&model);
  error_clear();
  return 0;
}
