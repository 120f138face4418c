#include "common/scratch_file.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/memory.h"
#include "common/output_file.h"

enum status scratch_open(const char *beside, struct scratch_file *scratch) {
  enum status status = STATUS_OK;
  char *path = NULL;
  int handle = -1;
  TRY(memory_allocate(&path, strlen(beside) + 9, 1, "a path"));
  sprintf(path, "%s.~XXXXXX", beside);
  if (!output_fails()) handle = mkstemp(path);
  if (handle >= 0) unlink(path);
  scratch->file = handle >= 0 ? fdopen(handle, "w+b") : NULL;
  if (scratch->file == NULL)
    TRY_FAIL(STATUS_RUN, "%s: no file can be made beside it: %s", beside, strerror(errno));
cleanup:
  if (status != STATUS_OK && handle >= 0) close(handle);
  memory_free(&path);
  return status;
}

static enum status failed(const char *why) {
  return FAIL(STATUS_RUN, "the scratch file beside the results: %s", why);
}

/* Large transfers are split into pieces. */
enum status scratch_write(const struct scratch_file *scratch, size_t offset, const void *data,
                          size_t size) {
  const char *from = data;
  while (size > 0) {
    const ssize_t done =
        output_fails() ? -1 : pwrite(fileno(scratch->file), from, size, (off_t)offset);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return failed(strerror(errno));
    from += done;
    offset += (size_t)done;
    size -= (size_t)done;
  }
  return STATUS_OK;
}

enum status scratch_read(const struct scratch_file *scratch, size_t offset, void *data,
                         size_t size) {
  char *to = data;
  while (size > 0) {
    const ssize_t done = pread(fileno(scratch->file), to, size, (off_t)offset);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return failed(done < 0 ? strerror(errno) : "it ends too early");
    to += done;
    offset += (size_t)done;
    size -= (size_t)done;
  }
  return STATUS_OK;
}

void scratch_close(struct scratch_file *scratch) {
  if (scratch->file != NULL) fclose(scratch->file);
  scratch->file = NULL;
}
