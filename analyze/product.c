#include "analyze/product.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "analyze/chart.h"
#include "analyze/plot.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/provenance.h"

enum status text_start(struct text *text) {
  text->stream = open_memstream(&text->data, &text->size);
  return text->stream != NULL ? STATUS_OK : FAIL(STATUS_RUN, "out of memory for a text");
}

enum status text_finish(struct text *text) {
  if (text->stream == NULL) return STATUS_OK;
  int bad = ferror(text->stream);
  bad |= fclose(text->stream) != 0;
  text->stream = NULL;
  return bad ? FAIL(STATUS_RUN, "out of memory for a text") : STATUS_OK;
}

void text_free(struct text *text) {
  if (text->stream != NULL) fclose(text->stream);
  free(text->data);
  memset(text, 0, sizeof *text);
}

enum status product_start(const char *name, struct product *product) {
  enum status status = STATUS_OK;
  memset(product, 0, sizeof *product);
  product->name = name;
  product->json = json_object();
  product->charts = json_array();
  if (product->json == NULL || product->charts == NULL)
    TRY_FAIL(STATUS_RUN, "out of memory for JSON");
  TRY(text_start(&product->csv));
  TRY(text_start(&product->plot));
  TRY(text_start(&product->summary));
cleanup:
  if (status != STATUS_OK) product_free(product);
  return status;
}

enum status product_finish(struct product *product) {
  enum status status = STATUS_OK;
  struct text script = {0};
  TRY(text_finish(&product->csv));
  TRY(text_finish(&product->plot));
  TRY(text_finish(&product->summary));
  chart_drop_empty(product->charts);
  if (json_array_size(product->charts) == 0) goto cleanup;
  TRY(text_start(&script));
  chart_script(product->charts, product->plot.data, script.stream, &product->width,
               &product->height);
  TRY(text_finish(&script));
  text_free(&product->plot);
  product->plot = script;
  script = (struct text){0};
cleanup:
  text_free(&script);
  return status;
}

void product_free(struct product *product) {
  json_decref(product->json);
  json_decref(product->charts);
  product->json = product->charts = NULL;
  text_free(&product->csv);
  text_free(&product->plot);
  text_free(&product->summary);
}

/* mkdir -p */
static enum status folder_make(const char *folder) {
  char path[4096];
  if (snprintf(path, sizeof path, "%s", folder) >= (int)sizeof path)
    return FAIL(STATUS_USAGE, "-o: the folder's name is too long");
  for (char *c = path + 1;; c++) {
    if (*c != '/' && *c != '\0') continue;
    char end = *c;
    *c = '\0';
    struct stat info;
    const int cause = mkdir(path, 0777) != 0 ? errno : 0;
    if (cause != 0 && (stat(path, &info) != 0 || !S_ISDIR(info.st_mode)))
      return FAIL(STATUS_RUN, "%s: the folder cannot be made (%s); choose another with -o", path,
                  strerror(cause));
    if (end == '\0') return STATUS_OK;
    *c = end;
  }
}

static enum status save_as(const struct product *product, const char *folder, const char *ending,
                           const char *data, size_t size) {
  char path[4200];
  if (snprintf(path, sizeof path, "%s/%s%s", folder, product->name, ending) >= (int)sizeof path)
    return FAIL(STATUS_USAGE, "-o: the folder's name is too long");
  return output_write(path, data, size);
}

/* Checks all files of a product together; the JSON file has the mark of Tosui for all. */
static enum status allow_all(const struct product *product, const char *folder) {
  enum status status = STATUS_OK;
  static const char *const endings[] = {"json", "csv", "gp", "svg", "png"};
  char path[4200];
  bool ours = false;
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
    if (snprintf(path, sizeof path, "%s/%s.%s", folder, product->name, endings[i]) >=
        (int)sizeof path)
      TRY_FAIL(STATUS_USAGE, "-o: the folder's name is too long");
    TRY(output_check_inputs(path));
    if (i == 0) ours = output_is_product(path);
    if (!ours) TRY(output_allow(path));
  }
cleanup:
  return status;
}

enum status product_save(const struct product *product, const char *folder) {
  enum status status = STATUS_OK;
  char *json = NULL;
  if (folder[0] == '\0') TRY_FAIL(STATUS_USAGE, "-o: give the name of a folder");
  TRY(folder_make(folder));
  TRY(allow_all(product, folder));
  json_object_set_new(product->json, "tosui_version", json_string(TOSUI_VERSION));
  json = json_dumps(product->json, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
  if (json == NULL) TRY_FAIL(STATUS_RUN, "out of memory for JSON");
  TRY(save_as(product, folder, ".json", json, strlen(json)));
  TRY(save_as(product, folder, ".csv", product->csv.data, product->csv.size));
  if (product->width > 0)
    TRY(plot_save(folder, product->name, product->plot.data, product->width, product->height));
cleanup:
  free(json);
  return status;
}

void product_add_run(struct product *product, json_t *object, size_t n) {
  json_t *list = json_object_get(product->json, "runs");
  if (list == NULL) json_object_set_new(product->json, "runs", list = json_array());
  if (n == 1) json_object_update(product->json, object);
  json_array_append_new(list, object);
}

void csv_text(FILE *stream, const char *text) {
  /* Spreadsheets compute a text that begins so. */
  const char *mark = text[0] != '\0' && strchr("=+-@\t\r", text[0]) != NULL ? "'" : "";
  const bool quoted = strpbrk(text, ",\"\r\n") != NULL;
  fprintf(stream, "%s%s", quoted ? "\"" : "", mark);
  for (; *text != '\0'; text++) {
    if (*text == '"') fputc('"', stream);
    fputc(*text, stream);
  }
  if (quoted) fputc('"', stream);
}

void write_percent(FILE *stream, double share) {
  double percent = 100.0 * share;
  int digits = fabs(percent) >= 10.0 ? 0 : fabs(percent) >= 1.0 ? 1 : fabs(percent) >= 0.1 ? 2 : 3;
  if (percent != 0.0 && fabs(percent) < 0.001)
    fputs("under 0.001 %", stream);
  else
    fprintf(stream, "%.*f %%", digits, percent);
}

/* Rounds to a multiple of 10^zeros. */
static double rounded(double value, int zeros) {
  const double unit = pow(10.0, zeros);
  return unit * round(value / unit);
}

const char *short_number(double value, int digits, char text[32]) {
  const int order = value != 0.0 ? (int)floor(log10(fabs(value))) : 0;
  if (order >= digits && order < 6)
    snprintf(text, 32, "%.0f", rounded(value, order - digits + 1));
  else
    snprintf(text, 32, "%.*g", digits, value);
  return text;
}

void value_with_error(char *text, size_t size, double value, double error, const char *sign) {
  const int order = value != 0.0 ? (int)floor(log10(fabs(value))) : 0;
  if (!isfinite(error)) {
    snprintf(text, size, "%.4g", value);
    return;
  }
  /* The error is at least the rounding error of the value, which has six digits. */
  if (error > 0) error = fmax(error, 0.5 * pow(10.0, order - 5));
  /* As many digits as to show two of the error. */
  int digits = error > 0 ? order - (int)floor(log10(error)) + 2 : 6;
  digits = digits < 2 ? 2 : digits > 6 ? 6 : digits;
  if (order >= -3 && order < 6) {
    const int decimals = digits - 1 - order;
    if (decimals < 0) value = rounded(value, -decimals);
    if (error >= 100.0) error = rounded(error, (int)floor(log10(error)) - 1);
    snprintf(text, size, error < 100.0 ? "%.*f %s %.2g" : "%.*f %s %.0f",
             decimals > 0 ? decimals : 0, value, sign, error);
  } else {
    const double unit = pow(10.0, order);
    snprintf(text, size, "(%.*f %s %.2g)e%+03d", digits - 1, value / unit, sign, error / unit,
             order);
  }
}

void write_value_with_error(FILE *stream, double value, double error, const char *sign,
                            const char *unit) {
  char text[80];
  if (!isfinite(error)) {
    fprintf(stream, "%.4g%s (error unknown)", value, unit);
    return;
  }
  if (value == 0 && error == 0) {
    fprintf(stream, "0%s", unit);
    return;
  }
  value_with_error(text, sizeof text, value, error, sign);
  fprintf(stream, "%s%s (", text, unit);
  write_percent(stream, error / fabs(value));
  fputc(')', stream);
}

void product_print_json(const json_t *json) {
  json_dumpf(json, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
  putchar('\n');
}
