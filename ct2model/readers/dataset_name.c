#include "ct2model/readers/dataset_name.h"

#include <stdbool.h>
#include <string.h>
#include <sys/stat.h>

#include "common/memory.h"

const char *dataset_name(const char *path) {
  struct stat info;
  if (stat(path, &info) == 0) return NULL;
  for (const char *at = strchr(path, ':'); at != NULL; at = strchr(at + 1, ':')) {
    char *file = NULL;
    if (memory_copy_text(path, (size_t)(at - path), &file) != STATUS_OK) return NULL;
    const bool is_file = stat(file, &info) == 0 && S_ISREG(info.st_mode);
    memory_free(&file);
    if (is_file) return at + 1;
  }
  return NULL;
}
