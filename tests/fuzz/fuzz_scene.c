/* libFuzzer: any text as a scene file. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "common/error.h"
#include "sphsolve/lattice.h"
#include "sphsolve/scene.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
const char *__lsan_default_suppressions(void);

/* libconfig 1.5 loses the buffer of a string that a syntax error cuts off; not ours to free. */
const char *__lsan_default_suppressions(void) { return "leak:strbuf_append\n"; }

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static char path[64];
  if (!*path) snprintf(path, sizeof path, "/dev/shm/tosui-fuzz-scene-%d", (int)getpid());
  FILE *file = fopen(path, "wb");
  if (file == NULL) abort();
  fwrite(data, 1, size, file);
  fclose(file);
  struct scene scene;
  if (scene_read(path, NULL, 0, &scene) == STATUS_OK) scene_free(&scene);
  error_clear();
  return 0;
}
