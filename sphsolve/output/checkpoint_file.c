#include "sphsolve/output/checkpoint_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "common/provenance.h"
#include "common/ranks.h"

static const char seal_mark[8] = "TOSUICK1";

static void paths(const char *prefix, char newest[4096], char older[4096], char fresh[4096]) {
  snprintf(newest, 4096, "%s.ckpt.hdf", prefix);
  snprintf(older, 4096, "%s.ckpt.1.hdf", prefix);
  snprintf(fresh, 4096, "%s.ckpt.new.hdf", prefix);
}

enum status checkpoint_create(const char *prefix, struct h5_file **file) {
  char newest[4096], older[4096], fresh[4096];
  paths(prefix, newest, older, fresh);
  return h5_create(fresh, file);
}

static enum status append_seal(const char *path) {
  enum status status = STATUS_OK;
  uint64_t hash;
  FILE *file = NULL;
  TRY(hash_file(path, &hash));
  file = fopen(path, "ab");
  if (file == NULL) TRY_FAIL(STATUS_RUN, "%s: %s", path, strerror(errno));
  if (output_fails() || fwrite(seal_mark, sizeof seal_mark, 1, file) != 1 ||
      fwrite(&hash, sizeof hash, 1, file) != 1 || fflush(file) != 0 || !output_sync(fileno(file)))
    TRY_FAIL(STATUS_RUN, "%s: %s", path, strerror(errno));
cleanup:
  if (file != NULL && fclose(file) != 0 && status == STATUS_OK)
    status = FAIL(STATUS_RUN, "%s: %s", path, strerror(errno));
  return status;
}

enum status checkpoint_commit(const char *prefix, struct h5_file *file) {
  enum status status = STATUS_OK;
  char newest[4096], older[4096], fresh[4096];
  paths(prefix, newest, older, fresh);
  TRY(h5_commit(file));
  if (ranks_own() > 0) return STATUS_OK;
  TRY(append_seal(fresh));
  if (access(newest, F_OK) == 0) TRY(output_rename(newest, older));
  TRY(output_rename(fresh, newest));
cleanup:
  if (status != STATUS_OK) unlink(fresh);
  return status;
}

/* True if the file ends in a trailer that matches its bytes. */
static bool seal_holds(const char *path) {
  uint64_t sealed = 0, found = 0;
  char mark[8];
  FILE *file = fopen(path, "rb");
  if (file == NULL) return false;
  const long start = fseek(file, -16, SEEK_END) == 0 ? ftell(file) : -1; /* of the trailer */
  const bool marked = start > 0 && fread(mark, sizeof mark, 1, file) == 1 &&
                      fread(&sealed, sizeof sealed, 1, file) == 1 &&
                      memcmp(mark, seal_mark, sizeof mark) == 0;
  fclose(file);
  const bool holds =
      marked && hash_file_start(path, (uint64_t)start, &found) == STATUS_OK && found == sealed;
  error_clear();
  return holds;
}

/* Cleans up after a killed run: it may have left a partial file, or a complete checkpoint that was
 * not renamed yet, possibly after the newest one was moved away. */
static void clear_up(const char *newest, const char *fresh) {
  char part[4096 + 6];
  snprintf(part, sizeof part, "%s.part", fresh);
  unlink(part);
  if (access(newest, F_OK) == 0 || !seal_holds(fresh) || rename(fresh, newest) != 0) unlink(fresh);
}

enum status checkpoint_open(const char *prefix, struct h5_file **file) {
  char newest[4096], older[4096], fresh[4096];
  paths(prefix, newest, older, fresh);
  *file = NULL;
  if (ranks_own() == 0) clear_up(newest, fresh);
  (void)ranks_agree(STATUS_OK);
  bool any = access(newest, F_OK) == 0 || access(older, F_OK) == 0;
  if (!any) return STATUS_OK;
  if (seal_holds(newest)) return h5_open_sealed(newest, file);
  if (seal_holds(older)) {
    log_warning("%s is missing or damaged; resuming from %s", newest, older);
    return h5_open_sealed(older, file);
  }
  return FAIL(STATUS_INPUT, "%s: is damaged, and so is the one before; remove both to start anew",
              newest);
}

/* Whether the file ends in a trailer, valid or not. */
static bool is_sealed(const char *path) {
  char mark[8];
  FILE *file = fopen(path, "rb");
  if (file == NULL) return false;
  const bool sealed = fseek(file, -16, SEEK_END) == 0 && fread(mark, sizeof mark, 1, file) == 1 &&
                      memcmp(mark, seal_mark, sizeof mark) == 0;
  fclose(file);
  return sealed;
}

void checkpoint_remove(const char *prefix) {
  char newest[4096], older[4096], fresh[4096];
  if (ranks_own() > 0) return;
  paths(prefix, newest, older, fresh);
  /* The newest last: the older one is not used as long as it exists. */
  if (is_sealed(older)) unlink(older);
  if (is_sealed(newest)) unlink(newest);
}
