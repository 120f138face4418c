#include "common/page.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/page_encode.h"

/* The next "@{" from `at`, or NULL. */
static const char *find_mark(const char *at, const char *end) {
  while ((at = memchr(at, '@', (size_t)(end - at))) != NULL && at + 1 < end && at[1] != '{') at++;
  return at != NULL && at + 1 < end ? at : NULL;
}

static const struct asset *find_asset(const struct asset *assets, size_t n, const char *name,
                                      size_t length) {
  for (size_t i = 0; i < n; i++)
    if (strlen(assets[i].name) == length && strncmp(assets[i].name, name, length) == 0)
      return &assets[i];
  return NULL;
}

/* Copies the template, with what @{NAME} stands for: the data, the mark of Tosui, or a file. */
static enum status expand(const struct asset *assets, size_t n, const char *data, FILE *out) {
  const char *end = assets[0].data + assets[0].size;
  for (const char *at = assets[0].data; at < end;) {
    const char *mark = find_mark(at, end);
    const char *close = mark != NULL ? memchr(mark, '}', (size_t)(end - mark)) : NULL;
    if (close == NULL) {
      fwrite(at, 1, (size_t)(end - at), out);
      break;
    }
    const char *name = mark + 2;
    const size_t length = (size_t)(close - name);
    const struct asset *asset = find_asset(assets, n, name, length);
    fwrite(at, 1, (size_t)(mark - at), out);
    if (strncmp(name, "data}", 5) == 0)
      encode_json(out, data);
    else if (strncmp(name, "mark}", 5) == 0)
      fputs(TOSUI_MARK, out);
    else if (asset == NULL)
      return FAIL(STATUS_RUN, "the page names a file %.*s that the program lacks", (int)length,
                  name);
    else if (strstr(asset->name, ".css") != NULL)
      fwrite(asset->data, 1, asset->size, out);
    else
      encode_script(out, asset->data, asset->size);
    at = close + 1;
  }
  return STATUS_OK;
}

enum status page_write(const char *path, const struct asset *assets, size_t n, const json_t *data) {
  enum status status = STATUS_OK;
  char *json = json_dumps(data, JSON_COMPACT | JSON_REAL_PRECISION(12)), *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (json == NULL || out == NULL) TRY_FAIL(STATUS_RUN, "%s: out of memory for the page", path);
  TRY(expand(assets, n, json, out));
  bool bad = ferror(out) != 0;
  bad |= fclose(out) != 0;
  out = NULL;
  if (bad) TRY_FAIL(STATUS_RUN, "%s: out of memory for the page", path);
  TRY(output_write(path, text, size));
cleanup:
  if (out != NULL) fclose(out);
  free(text);
  free(json);
  return status;
}
