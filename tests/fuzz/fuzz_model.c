/* libFuzzer: any bytes as a model file. */
#include "common/model_file.h"
#include "fuzz_hdf5.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *path = fuzz_file(".hdf", data, size);
  struct voxel_model model;
  if (model_read(path, &model) == STATUS_OK) model_free(&model);
  return fuzz_end(path, 0);
}
