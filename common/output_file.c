#include "common/output_file.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "common/memory.h"

static long fail_after;

bool output_fails(void) {
  if (fail_after == 0 || --fail_after > 0) return false;
  errno = ENOSPC;
  return true;
}

long output_fail_after(long n) {
  long left = fail_after;
  fail_after = n;
  return left;
}

enum status output_rename(const char *from, const char *to) {
  if (output_fails() || rename(from, to) != 0)
    return FAIL(STATUS_RUN, "%s: cannot be put in place: %s", to, strerror(errno));
  return STATUS_OK;
}

enum status output_write(const char *path, const char *data, size_t size) {
  enum status status = STATUS_OK;
  FILE *file = NULL;
  char *part = NULL;
  TRY(memory_allocate(&part, strlen(path) + 6, 1, "a path"));
  sprintf(part, "%s.part", path);
  file = fopen(part, "wb");
  if (file == NULL) TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  if (output_fails() || fwrite(data, 1, size, file) != size || fflush(file) != 0)
    TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  bool bad = fclose(file) != 0;
  file = NULL;
  if (bad) TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  TRY(output_rename(part, path));
cleanup:
  if (file != NULL) fclose(file);
  if (status != STATUS_OK && part != NULL) unlink(part);
  memory_free(&part);
  return status;
}
