#include "common/provenance.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <xxhash.h>

#include "common/memory.h"

uint64_t hash_bytes(const void *data, size_t size) {
  return XXH3_64bits(data, size);
}

enum status hash_file(const char *path, uint64_t *hash) {
  return hash_file_start(path, UINT64_MAX, hash);
}

enum status hash_file_start(const char *path, uint64_t size, uint64_t *hash) {
  enum status status = STATUS_OK;
  FILE *file = fopen(path, "rb");
  if (file == NULL) return FAIL(STATUS_INPUT, "%s: %s", path, strerror(errno));
  char block[1 << 16]; /* small enough for the L1 or L2 cache */
  XXH3_state_t *state = XXH3_createState();
  if (state == NULL) TRY_FAIL(STATUS_RUN, "memory for a hash could not be had");
  setvbuf(file, NULL, _IONBF, 0);
  XXH3_64bits_reset(state);
  size_t n;
  while ((n = fread(block, 1, size < sizeof block ? (size_t)size : sizeof block, file)) > 0) {
    XXH3_64bits_update(state, block, n);
    size -= n;
  }
  if (ferror(file)) TRY_FAIL(STATUS_INPUT, "%s: cannot be read", path);
  *hash = XXH3_64bits_digest(state);
cleanup:
  XXH3_freeState(state);
  fclose(file);
  return status;
}

enum status provenance_write(struct h5_file *file, const char *program, const char *command_line,
                             size_t input_count, const char *const *input_paths,
                             const uint64_t *input_hashes) {
  enum status status = STATUS_OK;
  char host[256] = "unknown", now[32];
  int schema = TOSUI_SCHEMA_VERSION;
  char(*hashes)[17] = NULL;
  const char **hash_texts = NULL;
  gethostname(host, sizeof host - 1);
  time_t seconds = time(NULL);
  struct tm utc;
  gmtime_r(&seconds, &utc);
  strftime(now, sizeof now, "%Y-%m-%dT%H:%M:%SZ", &utc);
  TRY(h5_make_group(file, "/provenance"));
  TRY(h5_write_attribute_text(file, "/provenance", "program", program));
  TRY(h5_write_attribute_text(file, "/provenance", "version", TOSUI_VERSION));
  TRY(h5_write_attribute(file, "/provenance", "schema_version", H5_I32, 1, &schema));
  TRY(h5_write_attribute_text(file, "/provenance", "command_line", command_line));
  TRY(h5_write_attribute_text(file, "/provenance", "host", host));
  TRY(h5_write_attribute_text(file, "/provenance", "time", now));
  TRY(memory_allocate(&hashes, input_count, sizeof *hashes, "hashes"));
  TRY(memory_allocate(&hash_texts, input_count, sizeof *hash_texts, "hashes"));
  for (size_t i = 0; i < input_count; i++) {
    snprintf(hashes[i], sizeof hashes[i], "%016llx", (unsigned long long)input_hashes[i]);
    hash_texts[i] = hashes[i];
  }
  TRY(h5_write_texts(file, "/provenance/input_files", input_count, input_paths));
  TRY(h5_write_texts(file, "/provenance/input_hashes", input_count, hash_texts));
cleanup:
  MEMORY_FREE(&hash_texts, &hashes);
  return status;
}

enum status provenance_check(struct h5_file *file) {
  const double schema = h5_attribute_or_nan(file, "/provenance", "schema_version");
  if (!(schema > TOSUI_SCHEMA_VERSION)) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s: is of schema version %.0f, this program reads up to %d; use a newer Tosui",
              h5_path(file), schema, TOSUI_SCHEMA_VERSION);
}

bool provenance_is_ours(const char *path) {
  struct h5_file *file = NULL;
  bool ours = false;
  if (h5_open_output(path, &file) == STATUS_OK) {
    /* Files without /provenance are recognised by their attributes: time and step of a snapshot,
     * state of the recorder in a checkpoint, times and numbers in the tracks of walkers. */
    ours = (h5_exists(file, "/provenance") &&
            h5_attribute_exists(file, "/provenance", "schema_version")) ||
           (h5_exists(file, "/VTKHDF") && h5_attribute_exists(file, "/", "time") &&
            h5_attribute_exists(file, "/", "step")) ||
           (h5_exists(file, "/VTKHDF/PointData/time") && h5_exists(file, "/VTKHDF/PointData/id")) ||
           h5_exists(file, "/recorder");
  }
  h5_close(file);
  error_clear();
  return ours;
}
