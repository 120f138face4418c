#define _GNU_SOURCE /* memmem */ // NOLINT: the name is the library's
#include "common/output_guard.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/hdf5_file.h"
#include "common/output_file.h"
#include "common/provenance.h"

static bool forced;

void output_start(bool force) {
  forced = force;
  /* Writing beyond the limit on file sizes then fails with an error message. */
  signal(SIGXFSZ, SIG_IGN);
  output_note_inputs();
}

static bool bears_mark(const char *text, size_t size) {
  static const char *const MARKS[] = {TOSUI_MARK,
                                      "threshold,void_ratio,",
                                      "axis,position_m,porosity,",
                                      "\"file-series-version\"",
                                      ",xxh3 (scene ",
                                      "\"tosui_version\""};
  for (size_t i = 0; i < sizeof MARKS / sizeof *MARKS; i++)
    if (memmem(text, size, MARKS[i], strlen(MARKS[i])) != NULL) return true;
  return false;
}

bool output_is_product(const char *path) {
  static const char SIGNATURE[] = "\x89HDF\r\n\x1a\n";
  char text[4096];
  FILE *file = fopen(path, "rb");
  if (file == NULL) return false;
  size_t got = fread(text, 1, sizeof text, file);
  bool ours = got == 0 || bears_mark(text, got);
  const bool hdf5 = got >= 8 && memcmp(text, SIGNATURE, 8) == 0;
  /* In an image the tags may follow the pixels. */
  if (!ours && !hdf5 && fseek(file, -(long)sizeof text, SEEK_END) == 0) {
    got = fread(text, 1, sizeof text, file);
    ours = bears_mark(text, got);
  }
  fclose(file);
  return ours || (hdf5 && provenance_is_ours(path));
}

enum status output_name(const char *path, const char *const *endings, const char *kind, char *named,
                        size_t size) {
  const char *slash = strrchr(path, '/'), *base = slash != NULL ? slash + 1 : path;
  const char *dot = strrchr(base, '.'), *added = "";
  struct stat info;
  const bool has_one = dot != NULL && dot != base && isalpha((unsigned char)dot[1]);
  bool known = false;
  for (int i = 0; has_one && !known && endings[i] != NULL; i++) known = !strcmp(dot, endings[i]);
  /* Folders and devices are refused by output_allow. */
  const bool other = stat(path, &info) == 0 && !S_ISREG(info.st_mode);
  if (has_one && !known && !other)
    return FAIL(STATUS_USAGE, "-o %s: %s; name it %s", path, kind, endings[0]);
  if (!has_one && !other && strcmp(base, "") && strcmp(base, ".") && strcmp(base, ".."))
    added = endings[0];
  if (snprintf(named, size, "%s%s", path, added) >= (int)size)
    return FAIL(STATUS_USAGE, "-o: the name of the output file is too long");
  return STATUS_OK;
}

static enum status check_folder(const char *path) {
  const char *slash = strrchr(path, '/');
  char folder[PATH_MAX] = ".";
  struct stat info;
  if (slash != NULL)
    snprintf(folder, sizeof folder, "%.*s", (int)(slash == path ? 1 : slash - path), path);
  if (stat(folder, &info) != 0)
    return FAIL(STATUS_RUN, "%s: cannot be written: the folder %s: %s; make it first", path, folder,
                strerror(errno));
  if (!S_ISDIR(info.st_mode))
    return FAIL(STATUS_RUN, "%s: cannot be written: %s is no folder", path, folder);
  /* A trial file is created and removed: permissions do not tell about file systems that accept no
   * files or about names that are too long. Its name is unique, because other ranks may test too.
   */
  char probe[OUTPUT_NAME_MAX + 8];
  snprintf(probe, sizeof probe, "%s.XXXXXX", path);
  const int file = mkstemp(probe);
  if (file < 0 && errno == ENAMETOOLONG)
    return FAIL(STATUS_RUN, "%s: cannot be written: %s; give a shorter one", path, strerror(errno));
  if (file < 0)
    return FAIL(STATUS_RUN,
                "%s: cannot be written: the folder %s takes no file: %s; choose another", path,
                folder, strerror(errno));
  close(file);
  unlink(probe);
  return STATUS_OK;
}

enum status output_allow(const char *path) {
  enum status status = STATUS_OK;
  struct stat info;
  char target[OUTPUT_NAME_MAX];
  if (path == NULL) return STATUS_OK;
  if (path[0] == '\0') return FAIL(STATUS_USAGE, "-o '': the name of a file is wanted");
  TRY(output_follow(path, target));
  TRY(check_folder(target));
  if (stat(path, &info) != 0) goto cleanup;
  if (!S_ISREG(info.st_mode))
    TRY_FAIL(STATUS_USAGE, "%s: is a %s, not a file to be written; give another name with -o", path,
             S_ISDIR(info.st_mode) ? "folder" : "device or pipe");
  TRY(output_check_inputs(path));
  if (!forced && !output_is_product(path))
    TRY_FAIL(STATUS_USAGE,
             "%s: is there already and is no product of Tosui's; give another name with -o, or "
             "--force to replace it",
             path);
cleanup:
  return status;
}

enum status output_allow_kind(const char *path, const char *group, const char *what) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  bool other = false;
  TRY(output_allow(path));
  if (path == NULL || forced || access(path, F_OK) != 0) return STATUS_OK;
  if (h5_open_output(path, &file) == STATUS_OK)
    other = h5_exists(file, group);
  else
    error_clear();
  h5_close(file);
  if (other)
    TRY_FAIL(STATUS_USAGE,
             "%s: is there already and is %s; give another name with -o, or --force to replace it",
             path, what);
cleanup:
  return status;
}
