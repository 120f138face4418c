#include "sphsolve/output/journal.h"

#include <errno.h>
#include <fcntl.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "common/provenance.h"

#define VALUE_WIDTH 26 /* of a number in 17 digits and its comma */
#define SYNC_INTERVAL                                                                              \
  5.0 /* s; a crash of the program loses nothing, one of the machine so much                       \
       */

/* Cuts the file after the header and at most `most` whole rows, and counts them; 0 bytes are left
 * where the header is not ours. */
static enum status keep_rows(struct journal *journal, size_t most) {
  enum status status = STATUS_OK;
  FILE *file = fopen(journal->path, "r");
  size_t room = (size_t)journal->width * VALUE_WIDTH + strlen(journal->header) + 64;
  char *line = NULL;
  off_t whole = 0;
  journal->count = 0;
  TRY(memory_allocate(&line, room, 1, "a row of the history"));
  while (file != NULL && fgets(line, (int)room, file) != NULL) {
    char *end = strchr(line, '\n'), *comma = strrchr(line, ',');
    if (end == NULL) break;
    *end = '\0';
    if (whole == 0) {
      if (strcmp(line, journal->header) != 0) break;
    } else {
      char hash[20] = "";
      if (comma != NULL)
        snprintf(hash, sizeof hash, "%016llx",
                 (unsigned long long)hash_bytes(line, (size_t)(comma - line)));
      if (comma == NULL || strcmp(comma + 1, hash) != 0 || journal->count == most) break;
      journal->count++;
    }
    whole += end - line + 1;
  }
  if (output_fails() || ftruncate(journal->file - 1, whole) != 0 ||
      lseek(journal->file - 1, whole, SEEK_SET) < 0)
    TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", journal->path, strerror(errno));
cleanup:
  if (file != NULL) fclose(file);
  memory_free(&line);
  return status;
}

/* A line that does not fit on the disk is taken back whole. */
static enum status append(struct journal *journal, const char *text, size_t size) {
  off_t before = lseek(journal->file - 1, 0, SEEK_CUR);
  ssize_t written = output_fails() ? -1 : write(journal->file - 1, text, size);
  if (written == (ssize_t)size) return STATUS_OK;
  int cause = written < 0 ? errno : ENOSPC;
  if (ftruncate(journal->file - 1, before) == 0) lseek(journal->file - 1, before, SEEK_SET);
  return FAIL(STATUS_RUN, "%s: cannot be written: %s", journal->path, strerror(cause));
}

enum status journal_open(struct journal *journal, const char *path, const char *header, int width,
                         size_t count, const double *rows, bool keep) {
  enum status status = STATUS_OK;
  journal->width = width;
  TRY(memory_copy_text(path, strlen(path), &journal->path));
  TRY(memory_copy_text(header, strlen(header), &journal->header));
  TRY(memory_allocate(&journal->line, (size_t)width * VALUE_WIDTH + 32, 1, "a row of the history"));
  journal->file = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0666) + 1;
  if (journal->file == 0) TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  if (keep) TRY(keep_rows(journal, SIZE_MAX));
  if (keep && journal->count >= count && journal->count > 0) goto cleanup;
  journal->count = 0;
  if (output_fails() || ftruncate(journal->file - 1, 0) != 0 ||
      lseek(journal->file - 1, 0, SEEK_SET) < 0)
    TRY_FAIL(STATUS_RUN, "%s: cannot be written: %s", path, strerror(errno));
  TRY(append(journal, journal->header, strlen(header)));
  TRY(append(journal, "\n", 1));
  for (size_t i = 0; i < count; i++) TRY(journal_row(journal, i, rows + i * (size_t)width));
cleanup:
  if (status != STATUS_OK) journal_close(journal, false);
  return status;
}

enum status journal_row(struct journal *journal, size_t index, const double *row) {
  enum status status = STATUS_OK;
  size_t n = 0;
  if (index < journal->count) return STATUS_OK;
  for (int i = 0; i < journal->width; i++)
    n += (size_t)snprintf(journal->line + n, VALUE_WIDTH + 1, i > 0 ? ",%.17g" : "%.17g", row[i]);
  uint64_t hash = hash_bytes(journal->line, n);
  n += (size_t)snprintf(journal->line + n, 20, ",%016llx\n", (unsigned long long)hash);
  TRY(append(journal, journal->line, n));
  journal->count++;
  if (clock_seconds() - journal->synced > SYNC_INTERVAL) {
    fdatasync(journal->file - 1);
    journal->synced = clock_seconds();
  }
cleanup:
  return status;
}

enum status journal_cut(struct journal *journal, size_t count) {
  return journal->file == 0 || journal->count <= count ? STATUS_OK : keep_rows(journal, count);
}

void journal_close(struct journal *journal, bool remove) {
  if (journal->file != 0) close(journal->file - 1);
  if (remove && journal->path != NULL) unlink(journal->path);
  memory_free(&journal->path);
  memory_free(&journal->header);
  memory_free(&journal->line);
  journal->file = 0;
}
