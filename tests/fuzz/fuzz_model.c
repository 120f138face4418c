/* libFuzzer: edits of a model file. */
#include "common/model_file.h"
#include "fuzz_edits.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static struct edit_base base;
  if (base.size == 0) edit_base_read("tests/fuzz/corpus/hdf5/model-full.hdf", 0, &base);
  const char *path = edit_file(&base, ".hdf", data, size);
  struct voxel_model model;
  if (model_read(path, &model) == STATUS_OK) model_free(&model);
  return fuzz_end(path, 0);
}
