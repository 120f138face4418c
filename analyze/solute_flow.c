#include "analyze/solute_flow.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "analyze/compatible_runs.h"
#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/provenance.h"

enum { HASH_TEXT = 17 };

bool solute_has(const char *path, const char *object) {
  struct h5_file *file = NULL;
  const bool has = h5_open(path, &file) == STATUS_OK && h5_exists(file, object);
  h5_close(file);
  error_clear();
  return has;
}

bool solute_any_has(const char *const *paths, size_t n, const char *object) {
  size_t i = 0;
  while (i < n && !solute_has(paths[i], object)) i++;
  return i < n;
}

/* Name and hash of the flow's file, as stored in the file of the solute. */
static enum status read_source(const char *path, char **flow, char hash[HASH_TEXT]) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  size_t files = 0, hashes = 0;
  char **file_names = NULL, **file_hashes = NULL;
  hash[0] = '\0';
  TRY(h5_open(path, &file));
  TRY(h5_read_attribute_text(file, "/solute", "flow", flow));
  if (!h5_exists(file, "/provenance/input_hashes")) goto cleanup;
  TRY(h5_read_texts(file, "/provenance/input_files", &files, &file_names));
  TRY(h5_read_texts(file, "/provenance/input_hashes", &hashes, &file_hashes));
  for (size_t i = 0; i < files && i < hashes; i++)
    if (strcmp(file_names[i], *flow) == 0) snprintf(hash, HASH_TEXT, "%s", file_hashes[i]);
cleanup:
  h5_free_texts(files, &file_names);
  h5_free_texts(hashes, &file_hashes);
  h5_close(file);
  return status;
}

static bool has_hash(const char *path, const char *hash) {
  uint64_t found = 0;
  char text[HASH_TEXT];
  if (access(path, R_OK) != 0) return false;
  if (hash_file(path, &found) != STATUS_OK) {
    error_clear();
    return false;
  }
  snprintf(text, sizeof text, "%016llx", (unsigned long long)found);
  return strcmp(text, hash) == 0;
}

/* Finds the flow's file: under the stored name or in the folder of the solute's file; "" if it is
 * missing or was changed. */
static void find_flow(const char *solute, const char *flow, const char *hash, char *path,
                      size_t size) {
  const char *slash = strrchr(solute, '/'), *base = strrchr(flow, '/');
  const int folder = slash == NULL ? 0 : (int)(slash - solute) + 1;
  const char *names[2] = {flow, base == NULL ? flow : base + 1};
  snprintf(path, size, "%s", flow);
  if (has_hash(path, hash)) return;
  for (int i = 0; i < 2; i++) {
    snprintf(path, size, "%.*s%s", folder, solute, names[i]);
    if (has_hash(path, hash)) return;
  }
  path[0] = '\0';
}

static const char *model_of(const struct run *run) {
  const char *slash = strrchr(run->model_path, '/');
  return *run->model_path == '\0' ? run->title : slash == NULL ? run->model_path : slash + 1;
}

static enum status check_one(const char *solute, const struct run *runs, size_t n, bool allowed) {
  enum status status = STATUS_OK;
  struct run flow = {0};
  char *name = NULL, hash[HASH_TEXT], path[8200], why[800];
  bool fits = false;
  TRY(read_source(solute, &name, hash));
  for (size_t i = 0; i < n && !fits; i++) fits = has_hash(runs[i].path, hash);
  if (fits) goto cleanup;
  find_flow(solute, name, hash, path, sizeof path);
  if (path[0] != '\0') {
    TRY(run_read(path, &flow));
    for (size_t i = 0; i < n && !fits; i++)
      fits = compatible_runs_same_model(&flow, &runs[i], true);
    if (fits) goto cleanup;
    snprintf(why, sizeof why, "another model (%s) than the runs' (%s)", model_of(&flow),
             model_of(&runs[0]));
  } else {
    snprintf(why, sizeof why, "none of the runs, and not there as it was to compare");
  }
  if (allowed)
    log_info("%s: carried by the flow of %s, %s", solute, name, why);
  else
    status = FAIL(STATUS_INPUT,
                  "%s: carried by the flow of %s, %s; give that flow's run with it, or --mix to "
                  "show them together",
                  solute, name, why);
cleanup:
  run_free(&flow);
  memory_free(&name);
  return status;
}

enum status solute_flow_check(const char *const *solutes, size_t count, const struct run *runs,
                              size_t n, bool allowed) {
  enum status status = STATUS_OK;
  for (size_t i = 0; i < count; i++) TRY(check_one(solutes[i], runs, n, allowed));
cleanup:
  return status;
}
