/* libFuzzer: any bytes as an STL file. */
#include "fuzz_input.h"
#include "sphsolve/scene/stl.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const char *path = fuzz_file(".stl", data, size);
  struct stl stl;
  (void)stl_read(path, 1e-3, &stl);
  stl_free(&stl);
  return fuzz_end(path, 0);
}
