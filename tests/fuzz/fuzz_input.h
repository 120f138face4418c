/* What the fuzz targets share: the bytes of libFuzzer as a file, and bounds on memory. */
#ifndef TOSUI_FUZZ_INPUT_H
#define TOSUI_FUZZ_INPUT_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "common/error.h"
#include "common/log.h"
#include "common/memory.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
const char *__lsan_default_suppressions(void);
const char *__asan_default_options(void);

/* A refused allocation inside a library is its own to handle, as it is without the sanitizer. A
 * short quarantine keeps the process small: to fork one of 360 MB takes longer than the probe. */
const char *__asan_default_options(void) {
  return "allocator_may_return_null=1:quarantine_size_mb=8";
}

/* Writes the bytes to a file of this process in memory, whose name ends in `ending`. */
__attribute__((unused)) static inline const char *fuzz_file(const char *ending, const uint8_t *data,
                                                            size_t size) {
  static char path[96];
  log_start("fuzz", LOG_QUIET);
  memory_set_limit((size_t)1 << 26);
  snprintf(path, sizeof path, "%s/tosui-fuzz-%d%s", access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm",
           (int)getpid(), ending);
  FILE *file = fopen(path, "wb");
  if (file == NULL) abort();
  if (fwrite(data, 1, size, file) != size || fclose(file) != 0) abort();
  return path;
}

/* Nothing may be left: neither a message nor a byte beyond those `held` before. */
static inline int fuzz_end(const char *path, size_t held) {
  error_clear();
  if (path != NULL) unlink(path);
  if (memory_in_use() != held) {
    fprintf(stderr, "%zu bytes held, not %zu\n", memory_in_use(), held);
    abort();
  }
  return 0;
}

/* HDF5 1.10 loses parts of its tables when it gives up on a damaged file, libconfig 1.5 the strings
 * of a text that a syntax error cuts off; not ours to free. */
const char *__lsan_default_suppressions(void) {
  return "leak:libhdf5\nleak:^H5\nleak:libconfig\n";
}

#endif
