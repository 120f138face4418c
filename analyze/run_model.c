#include "analyze/run_model.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/provenance.h"

/* Whether the file is the model of the run. If the run has no hash of 16 digits, or the file cannot
 * be read, it is accepted, and errors are left to its reader. */
static bool is_model_of(const char *path, const char *hash) {
  uint64_t found = 0;
  char text[17];
  if (hash == NULL || strlen(hash) != 16 || strspn(hash, "0") == 16) return true;
  if (hash_file(path, &found) != STATUS_OK) {
    error_clear();
    return true;
  }
  snprintf(text, sizeof text, "%016llx", (unsigned long long)found);
  return strcmp(text, hash) == 0;
}

enum status run_model_find(struct h5_file *file, const char *folder, const char *named,
                           char **model, bool *other) {
  enum status status = STATUS_OK;
  const char *slash = strrchr(named, '/');
  const char *base = slash == NULL ? named : slash + 1;
  const char *const places[3][2] = {{"", named}, {folder, named}, {folder, base}};
  char *hash = NULL;
  char path[8200] = "";
  bool found = false;
  *other = false;
  if (h5_attribute_exists(file, "/run", "model_hash"))
    status = h5_read_attribute_text(file, "/run", "model_hash", &hash);
  if (status == STATUS_INPUT) { /* a number, written by another program */
    error_clear();
    status = STATUS_OK;
  }
  TRY(status);
  for (int i = 0; i < 3 && !found; i++) {
    snprintf(path, sizeof path, "%s%s", places[i][0], places[i][1]);
    if (places[i][1][0] == '\0' || access(path, R_OK) != 0) continue;
    found = is_model_of(path, hash);
    *other |= !found;
  }
  if (found) *other = false;
  if (*other)
    log_warning("%s: the model file %s is not the one that was run (it was changed or replaced "
                "since): nothing is taken from it",
                h5_path(file), named);
  TRY(memory_allocate(model, sizeof path, 1, "text"));
  if (found) snprintf(*model, sizeof path, "%s", path);
cleanup:
  memory_free(&hash);
  return status;
}
