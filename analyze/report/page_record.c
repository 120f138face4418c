#include "analyze/report/page_record.h"

#include <math.h>
#include <string.h>

#include "analyze/report/page_html.h"
#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/provenance.h"

struct texts {
  size_t count;
  char **text;
};

static enum status read_texts(struct h5_file *file, const char *name, struct texts *texts) {
  if (!h5_exists(file, name)) return STATUS_OK;
  return h5_read_texts(file, name, &texts->count, &texts->text);
}

static const char *text_at(const struct texts *texts, size_t i) {
  return i < texts->count ? texts->text[i] : "";
}

static void cell(FILE *stream, const char *text) {
  fputs("<td>", stream);
  html_text(stream, text);
  fputs("</td>", stream);
}

enum { NAME, STATE, REASON, MODEL, CITATION, EFFECT_TEXTS };

static void effect_row(const struct texts effects[EFFECT_TEXTS], size_t i, double share,
                       FILE *stream) {
  const bool on = strcmp(text_at(&effects[STATE], i), "on") == 0;
  fprintf(stream, "<tr class=\"%s\">", on ? "on" : "off");
  cell(stream, effects[NAME].text[i]);
  cell(stream, text_at(&effects[STATE], i));
  cell(stream, text_at(&effects[REASON], i));
  fputs("<td>", stream);
  html_text(stream, text_at(&effects[MODEL], i));
  if (text_at(&effects[CITATION], i)[0] != '\0') {
    fputs(" <span class=\"cite\">", stream);
    html_text(stream, text_at(&effects[CITATION], i));
    fputs("</span>", stream);
  }
  if (share > 0)
    fprintf(stream, "</td><td class=\"number\">%.1f&nbsp;%%</td></tr>\n", 100.0 * share);
  else
    fputs("</td><td></td></tr>\n", stream);
}

enum status page_effects(const struct run *run, FILE *stream) {
  enum status status = STATUS_OK;
  static const char *const columns[EFFECT_TEXTS] = {"name", "state", "reason", "model", "citation"};
  struct texts effects[EFFECT_TEXTS] = {0}, passes = {0};
  double *share = NULL, *seconds = NULL;
  size_t shares = 0, times = 0;
  struct h5_file *file = NULL;
  TRY(h5_open(run->path, &file));
  for (int i = 0; i < EFFECT_TEXTS; i++) {
    char name[64];
    snprintf(name, sizeof name, "/run/effects/%s", columns[i]);
    TRY(read_texts(file, name, &effects[i]));
  }
  if (h5_exists(file, "/run/effects/share"))
    TRY(h5_read(file, "/run/effects/share", H5_F64, 1, &shares, &share));
  if (h5_exists(file, "/run/timing/seconds"))
    TRY(h5_read(file, "/run/timing/seconds", H5_F64, 1, &times, &seconds));
  TRY(read_texts(file, "/run/timing/name", &passes));

  bool timed = false; /* for methods that measure the time of each effect */
  for (size_t i = 0; i < shares; i++) timed |= share[i] > 0.0;
  for (int on = 1; on >= 0; on--) {
    if (!on)
      fputs("<details><summary>Effects that are off, and the time of each pass</summary>\n",
            stream);
    fprintf(
        stream,
        "<div class=\"wide\"><table><thead><tr><th>Effect</th><th></th><th>Why</th><th>Model</th>"
        "<th>%s</th></tr></thead><tbody>\n",
        timed ? "Time" : "");
    for (size_t i = 0; i < effects[NAME].count; i++) {
      if ((strcmp(text_at(&effects[STATE], i), "on") == 0) != (on == 1)) continue;
      effect_row(effects, i, i < shares ? share[i] : 0.0, stream);
    }
    fputs("</tbody></table></div>\n", stream);
  }
  if (passes.count > 0)
    fputs("<table class=\"facts\"><thead><tr><th>Pass</th><th "
          "class=\"number\">Seconds</th></tr></thead>"
          "<tbody>\n",
          stream);
  for (size_t i = 0; i < passes.count && i < times; i++) {
    fputs("<tr>", stream);
    cell(stream, passes.text[i]);
    fprintf(stream, "<td class=\"number\">%.3g</td></tr>\n", seconds[i]);
  }
  if (passes.count > 0) fputs("</tbody></table>\n", stream);
  fputs("</details>\n", stream);
cleanup:
  for (int i = 0; i < EFFECT_TEXTS; i++) h5_free_texts(effects[i].count, &effects[i].text);
  h5_free_texts(passes.count, &passes.text);
  memory_free(&share);
  memory_free(&seconds);
  h5_close(file);
  return status;
}

/* Writes one attribute as a row: a number, a few numbers, or text. */
static void attribute_row(struct h5_file *file, const char *object, const char *name,
                          FILE *stream) {
  double numbers[3];
  char *text = NULL;
  fprintf(stream, "<tr><th>");
  html_text(stream, name);
  fputs("</th><td>", stream);
  if (h5_read_attribute(file, object, name, H5_F64, 1, numbers) == STATUS_OK) {
    if (isnan(numbers[0]))
      fputs("none", stream);
    else
      fprintf(stream, "%.10g", numbers[0]);
  } else {
    error_clear();
    if (h5_read_attribute(file, object, name, H5_F64, 3, numbers) == STATUS_OK)
      fprintf(stream, "%.8g, %.8g, %.8g", numbers[0], numbers[1], numbers[2]);
    else {
      error_clear();
      if (h5_read_attribute_text(file, object, name, &text) == STATUS_OK)
        html_text(stream, text);
      else
        error_clear();
    }
  }
  memory_free(&text);
  fputs("</td></tr>\n", stream);
}

static enum status attribute_rows(struct h5_file *file, const char *object, FILE *stream) {
  enum status status = STATUS_OK;
  size_t count = 0;
  char **names = NULL;
  TRY(h5_list_attributes(file, object, &count, &names));
  for (size_t i = 0; i < count; i++) attribute_row(file, object, names[i], stream);
cleanup:
  h5_free_texts(count, &names);
  return status;
}

/* Inputs that are listed; a model may be made from thousands of slices. */
enum { INPUTS_SHOWN = 12 };

enum status page_provenance(const char *name, const char *path, FILE *stream) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  struct texts files = {0}, hashes = {0};
  char *scene = NULL;
  TRY(h5_open(path, &file));
  fputs("<details><summary>", stream);
  html_text(stream, name);
  fputs(" <span class=\"path\">", stream);
  html_text(stream, path);
  fputs("</span></summary>\n<div class=\"wide\"><table class=\"facts\"><tbody>\n", stream);
  if (h5_exists(file, "/provenance")) {
    TRY(attribute_rows(file, "/provenance", stream));
    TRY(read_texts(file, "/provenance/input_files", &files));
    TRY(read_texts(file, "/provenance/input_hashes", &hashes));
  }
  for (size_t i = 0; i < files.count && i < INPUTS_SHOWN; i++) {
    fputs("<tr><th>input, XXH3</th><td>", stream);
    html_text(stream, files.text[i]);
    fputs("<br><code>", stream);
    html_text(stream, text_at(&hashes, i));
    fputs("</code></td></tr>\n", stream);
  }
  if (files.count > INPUTS_SHOWN)
    fprintf(stream, "<tr><th>inputs more</th><td>%zu, in the file</td></tr>\n",
            files.count - INPUTS_SHOWN);
  if (h5_exists(file, "/run")) TRY(attribute_rows(file, "/run", stream));
  fputs("</tbody></table></div>\n", stream);
  if (h5_exists(file, "/run/scene")) {
    TRY(h5_read_text(file, "/run/scene", &scene));
    fputs("<pre>", stream);
    html_text(stream, scene);
    fputs("</pre>\n", stream);
  }
  fputs("</details>\n", stream);
cleanup:
  h5_free_texts(files.count, &files.text);
  h5_free_texts(hashes.count, &hashes.text);
  memory_free(&scene);
  h5_close(file);
  return status;
}
