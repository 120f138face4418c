#include "common/output_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/interrupt.h"
#include "common/memory.h"

#define LINKS_MAX 40 /* symbolic links followed at most, as in Linux */

static bool (*asked)(void);

bool output_fails(void) {
  if (asked == NULL || !asked()) return false;
  errno = ENOSPC;
  return true;
}

void output_ask_fails(bool (*fails)(void)) {
  asked = fails;
}

/* Input files, identified by device and inode instead of by name. Kept until the program ends, in
 * memory that is not counted. */
static struct {
  dev_t device;
  ino_t number;
} * inputs;
static size_t input_count, input_room;
static bool noting;

void output_note_inputs(void) {
  noting = true;
}

void output_protect(const char *path) {
  struct stat info;
  if (!noting || stat(path, &info) != 0 || !S_ISREG(info.st_mode)) return;
  if (input_count == input_room) {
    const size_t room = input_room == 0 ? 64 : 2 * input_room;
    void *more = room < SIZE_MAX / sizeof *inputs ? realloc(inputs, room * sizeof *inputs) : NULL;
    if (more == NULL) return;
    inputs = more;
    input_room = room;
  }
  inputs[input_count].device = info.st_dev;
  inputs[input_count++].number = info.st_ino;
}

enum status output_check_inputs(const char *path) {
  struct stat info;
  if (input_count == 0 || stat(path, &info) != 0) return STATUS_OK;
  for (size_t i = 0; i < input_count; i++)
    if (inputs[i].device == info.st_dev && inputs[i].number == info.st_ino)
      return FAIL(STATUS_USAGE,
                  "%s: would be overwritten, and it is an input of this run; give another name "
                  "with -o",
                  path);
  return STATUS_OK;
}

enum status output_follow(const char *path, char target[OUTPUT_NAME_MAX]) {
  char link[OUTPUT_NAME_MAX];
  size_t length = strlen(path);
  if (length >= OUTPUT_NAME_MAX)
    return FAIL(STATUS_USAGE, "%.40s...: the name of an output is too long", path);
  memcpy(target, path, length + 1);
  for (int hop = 0; hop < LINKS_MAX; hop++) {
    const ssize_t got = readlink(target, link, sizeof link);
    if (got < 0) return STATUS_OK;
    const char *slash = link[0] == '/' ? NULL : strrchr(target, '/');
    const size_t folder = slash != NULL ? (size_t)(slash + 1 - target) : 0;
    length = folder + (size_t)got;
    if (length >= OUTPUT_NAME_MAX)
      return FAIL(STATUS_USAGE, "%s: is a link to a name that is too long", path);
    memcpy(target + folder, link, (size_t)got);
    target[length] = '\0';
  }
  return FAIL(STATUS_USAGE, "%s: is a link that leads back to itself", path);
}

bool output_sync(int descriptor) {
  return interrupt_came() || fsync(descriptor) == 0;
}

enum status output_rename(const char *from, const char *to) {
  enum status status = output_check_inputs(to);
  if (status != STATUS_OK) return status;
  if (output_fails() || rename(from, to) != 0)
    return FAIL(STATUS_RUN, "%s: cannot be put in place: %s", to, strerror(errno));
  return STATUS_OK;
}

enum status output_write(const char *path, const char *data, size_t size) {
  enum status status = STATUS_OK;
  FILE *file = NULL;
  char *part = NULL, target[OUTPUT_NAME_MAX];
  TRY(output_follow(path, target));
  TRY(memory_allocate(&part, strlen(target) + 6, 1, "a path"));
  sprintf(part, "%s.part", target);
  file = fopen(part, "wb");
  if (file == NULL) TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  if (output_fails() || fwrite(data, 1, size, file) != size || fflush(file) != 0)
    TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  bool bad = fclose(file) != 0;
  file = NULL;
  if (bad) TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  TRY(output_rename(part, target));
cleanup:
  if (file != NULL) fclose(file);
  if (status != STATUS_OK && part != NULL) unlink(part);
  memory_free(&part);
  return status;
}

enum status output_flush(void) {
  errno = 0;
  if (fflush(stdout) == 0 && !ferror(stdout)) return STATUS_OK;
  return FAIL(STATUS_RUN, "stdout: cannot be written%s%s", errno ? ": " : "",
              errno ? strerror(errno) : "");
}
