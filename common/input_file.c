#include "common/input_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum status input_open(const char *path, FILE **file) {
  struct stat info;
  *file = NULL;
  const int handle = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (handle < 0 || fstat(handle, &info) != 0) {
    const char *why = strerror(errno);
    if (handle >= 0) close(handle);
    return FAIL(STATUS_INPUT, "%s: cannot be opened (%s); is the path right?", path, why);
  }
  if (S_ISREG(info.st_mode)) *file = fdopen(handle, "rb");
  if (*file != NULL) return STATUS_OK;
  close(handle);
  return FAIL(STATUS_INPUT, "%s: is a %s, not a file", path,
              S_ISDIR(info.st_mode) ? "folder" : "pipe or device");
}
