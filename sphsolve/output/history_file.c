#include "sphsolve/output/history_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/text.h"
#include "common/output_file.h"
#include "common/provenance.h"

#define VALUE_WIDTH 26 /* width of a number with 17 digits and its comma */
/* s: a crash of the program loses nothing, a crash of the machine the rows of this interval */
#define SYNC_INTERVAL 5.0

/* Truncates the file after the header and at most `most` complete rows, and counts them; to 0 bytes
 * if the header differs. */
static enum status keep_rows(struct history_file *history, size_t most) {
  enum status status = STATUS_OK;
  FILE *file = fopen(history->path, "r");
  size_t room = (size_t)history->width * VALUE_WIDTH + strlen(history->header) + 64;
  char *line = NULL;
  off_t whole = 0;
  history->count = 0;
  TRY(memory_allocate(&line, room, 1, "a row of the history"));
  while (file != NULL && fgets(line, (int)room, file) != NULL) {
    char *end = strchr(line, '\n'), *comma = strrchr(line, ',');
    if (end == NULL) break;
    *end = '\0';
    if (whole == 0) {
      if (strcmp(line, history->header) != 0) break;
    } else {
      char hash[20] = "";
      if (comma != NULL)
        snprintf(hash, sizeof hash, "%016llx",
                 (unsigned long long)hash_bytes(line, (size_t)(comma - line)));
      if (comma == NULL || strcmp(comma + 1, hash) != 0 || history->count == most) break;
      history->count++;
    }
    whole += end - line + 1;
  }
  if (output_fails() || ftruncate(history->file - 1, whole) != 0 ||
      lseek(history->file - 1, whole, SEEK_SET) < 0)
    TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", history->path, strerror(errno));
cleanup:
  if (file != NULL) fclose(file);
  memory_free(&line);
  return status;
}

/* Appends text; if the disk is full, the incomplete text is removed again. */
static enum status append(struct history_file *history, const char *text, size_t size) {
  off_t before = lseek(history->file - 1, 0, SEEK_CUR);
  ssize_t written = output_fails() ? -1 : write(history->file - 1, text, size);
  if (written == (ssize_t)size) return STATUS_OK;
  int cause = written < 0 ? errno : ENOSPC;
  if (ftruncate(history->file - 1, before) == 0) lseek(history->file - 1, before, SEEK_SET);
  return FAIL(STATUS_RUN, "%s: cannot be written: %s", history->path, strerror(cause));
}

enum status history_file_open(struct history_file *history, const char *path, const char *header,
                              int width, size_t count, const double *rows, bool keep) {
  enum status status = STATUS_OK;
  history->width = width;
  TRY(memory_copy_text(path, strlen(path), &history->path));
  TRY(memory_copy_text(header, strlen(header), &history->header));
  TRY(memory_allocate(&history->line, (size_t)width * VALUE_WIDTH + 32, 1, "a row of the history"));
  history->file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666) + 1;
  if (history->file == 0) TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  if (keep) TRY(keep_rows(history, SIZE_MAX));
  if (keep && history->count >= count && history->count > 0) goto cleanup;
  history->count = 0;
  if (output_fails() || ftruncate(history->file - 1, 0) != 0 ||
      lseek(history->file - 1, 0, SEEK_SET) < 0)
    TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  TRY(append(history, history->header, strlen(header)));
  TRY(append(history, "\n", 1));
  for (size_t i = 0; i < count; i++) TRY(history_file_row(history, i, rows + i * (size_t)width));
cleanup:
  if (status != STATUS_OK) history_file_close(history, false);
  return status;
}

enum status history_file_row(struct history_file *history, size_t index, const double *row) {
  enum status status = STATUS_OK;
  size_t n = 0;
  if (index < history->count) return STATUS_OK;
  for (int i = 0; i < history->width; i++)
    n += (size_t)snprintf(history->line + n, VALUE_WIDTH + 1, i > 0 ? ",%.17g" : "%.17g",
                          text_number(row[i]));
  uint64_t hash = hash_bytes(history->line, n);
  n += (size_t)snprintf(history->line + n, 20, ",%016llx\n", (unsigned long long)hash);
  TRY(append(history, history->line, n));
  history->count++;
  if (clock_seconds() - history->synced > SYNC_INTERVAL) {
    fdatasync(history->file - 1);
    history->synced = clock_seconds();
  }
cleanup:
  return status;
}

enum status history_file_truncate(struct history_file *history, size_t count) {
  return history->file == 0 || history->count <= count ? STATUS_OK : keep_rows(history, count);
}

void history_file_close(struct history_file *history, bool remove) {
  if (history->file != 0) close(history->file - 1);
  if (remove && history->path != NULL) unlink(history->path);
  MEMORY_FREE(&history->path, &history->header, &history->line);
  history->file = 0;
}
