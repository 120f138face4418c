/* libFuzzer: any text as a scene file; what follows a zero byte as --set. */
#include <string.h>

#include "fuzz_input.h"
#include "sphsolve/scene/scene_read.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  const uint8_t *end = size > 0 ? memchr(data, '\0', size) : NULL;
  size_t length = end != NULL ? (size_t)(end - data) : size, n = 0;
  char override[256] = "";
  const char *overrides[] = {override};
  if (end != NULL) {
    n = size - length - 1 < sizeof override ? size - length - 1 : sizeof override - 1;
    memcpy(override, end + 1, n);
  }
  const char *path = fuzz_file(".cfg", data, length);
  struct scene scene;
  if (scene_read(path, overrides, n > 0, &scene) == STATUS_OK) scene_free(&scene);
  return fuzz_end(path, 0);
}
