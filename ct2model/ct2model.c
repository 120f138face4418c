/* ct2model: CT slices to a calibrated voxel model. */
#include <jansson.h>
#include <limits.h>
#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/json_number.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/threads.h"
#include "ct2model/describe.h"
#include "ct2model/model/export_profile.h"
#include "ct2model/model/export_tiff.h"
#include "ct2model/model_output.h"
#include "ct2model/pipeline.h"
#include "ct2model/report.h"
#include "ct2model/request.h"
#include "ct2model/survey_page.h"
#include "ct2model/calibrate/sweep_table.h"

/* Turns the request into that of a coarser level of `finest` and names its file. */
static void coarsen(const struct pipeline *finest, int level, struct request *request,
                    char output[PATH_MAX]) {
  static const double ratios[] = {1.0, 1.5, 2.0, 3.0, 4.0};
  const char *path = finest->request->output, *dot = strrchr(path, '.');
  if (dot != NULL && strchr(dot, '/') != NULL) dot = NULL;
  for (int a = 0; a < 3; a++) {
    const size_t n = finest->model.size[a];
    const bool mirrored = request->mirror && a == request->mirror_axis;
    const double kept = (double)(mirrored ? (n + 1) / 2 : n);
    request->size[a] = (size_t)fmax(1.0, round(kept / ratios[level]));
  }
  request->size_given = true;
  snprintf(output, PATH_MAX, "%.*s-%zu%s", dot ? (int)(dot - path) : (int)strlen(path), path,
           request->size[0], dot ? dot : "");
  request->output = output;
}

static enum status run_level(const struct options *options, const struct request *request,
                             const char *const *paths, const char *key,
                             const struct pipeline *finer, struct pipeline *pipeline,
                             json_t **json) {
  enum status status = STATUS_OK;
  const bool build = strcmp(options_command(options), "build") == 0;
  TRY(pipeline_run(request, paths, options_operand_count(options), build, finer, pipeline));
  if (build)
    TRY(model_output_write(pipeline, options));
  else if (request->survey)
    TRY(survey_page_write(pipeline, options));
  else if (request->output != NULL)
    TRY(sweep_table_write(&pipeline->table, request->output));
  TRY(report_print(pipeline, options, key, json));
cleanup:
  return status;
}

/* Makes the model of a request and its coarser levels. `key`: the key of a further request's model
 * in the JSON object of the first one. */
static enum status run_levels(const struct options *options, const struct request *request,
                              const char *const *paths, const char *key, json_t **json) {
  enum status status = STATUS_OK;
  struct pipeline finest = {0}, coarser = {0};
  char output[PATH_MAX];
  json_t *own = NULL;
  TRY(run_level(options, request, paths, key, NULL, &finest, *json == NULL ? json : &own));
  for (int level = 1; level < request->levels; level++) {
    struct request less = *request;
    coarsen(&finest, level, &less, output);
    TRY(run_level(options, &less, paths, "coarser", &finest, &coarser, own != NULL ? &own : json));
    pipeline_end(&coarser);
    coarser = (struct pipeline){0};
  }
  if (own != NULL) {
    if (json_object_get(*json, key) == NULL) json_object_set_new(*json, key, json_array());
    json_array_append(json_object_get(*json, key), own);
  }
cleanup:
  json_decref(own);
  pipeline_end(&finest);
  pipeline_end(&coarser);
  return status;
}

/* "model.hdf" of the i-th void ratio: "model-e0.75.hdf". */
static void name_void_ratio(const char *path, double void_ratio, char output[PATH_MAX]) {
  const char *dot = strrchr(path, '.');
  if (dot == NULL || strchr(dot, '/') != NULL) dot = path + strlen(path);
  snprintf(output, PATH_MAX, "%.*s-e%g%s", (int)(dot - path), path, void_ratio, dot);
}

static enum status run_pipeline(const struct options *options, const struct request *request) {
  enum status status = STATUS_OK;
  const bool build = strcmp(options_command(options), "build") == 0;
  const size_t n = options_operand_count(options);
  const char **paths = NULL;
  char output[PATH_MAX];
  json_t *json = NULL;
  TRY(memory_allocate(&paths, n, sizeof *paths, "file names"));
  for (size_t i = 0; i < n; i++) paths[i] = options_operand(options, i);
  struct request one = *request;
  for (size_t i = 0; i == 0 || i < request->void_ratio_count; i++) {
    if (request->void_ratio_count > 1) {
      one.void_ratio = request->void_ratios[i];
      one.void_ratio_error = request->void_ratio_errors[i];
      if (build) {
        name_void_ratio(request->output, one.void_ratio, output);
        one.output = output;
      } else {
        /* The curve is the same for all void ratios: it is written once, with the last one. */
        one.output = i + 1 < request->void_ratio_count ? NULL : request->output;
      }
      if (!options_json(options) && log_level() > LOG_QUIET)
        printf("%svoid ratio %g\n", i > 0 ? "\n" : "", one.void_ratio);
    }
    TRY(run_levels(options, &one, paths, "void_ratios", &json));
  }
  TRY(report_end(&json));
cleanup:
  json_decref(json);
  memory_free(&paths);
  return status;
}

static enum status run_export(const struct options *options) {
  enum status status = STATUS_OK;
  struct voxel_model model = {0};
  const char *output = options_text(options, "output");
  if (output == NULL) return FAIL(STATUS_USAGE, "export: -o STACK.tif is wanted");
  const char *ending = strrchr(output, '.');
  const bool profile = ending != NULL && strcmp(ending, ".csv") == 0;
  if (!profile && (ending == NULL || (strcmp(ending, ".tif") != 0 && strcmp(ending, ".tiff") != 0)))
    TRY_FAIL(STATUS_USAGE,
             "export: -o %s: a stack of slices is named .tif, profiles of porosity and pore width "
             ".csv",
             output);
  TRY(model_read(options_operand(options, 0), &model));
  TRY(output_allow(output));
  TRY(profile ? export_profile(output, &model) : export_tiff(output, &model));
  const size_t *n = model.size;
  if (options_json(options)) {
    json_t *json = json_pack("{s:o, s:[I,I,I]}", "output", json_text(output), "size",
                             (json_int_t)n[0], (json_int_t)n[1], (json_int_t)n[2]);
    json_dumpf(json, stdout, JSON_INDENT(1));
    json_decref(json);
    putchar('\n');
  } else if (log_level() > LOG_QUIET && profile) {
    printf("%s: porosity and pore width of %zu, %zu and %zu layers along x, y and z\n", output,
           n[0], n[1], n[2]);
  } else if (log_level() > LOG_QUIET) {
    printf("%s: %zux%zux%zu, 8 bits, 255 grain, 0 pore\n", output, n[0], n[1], n[2]);
  }
cleanup:
  model_free(&model);
  return status;
}

int main(int argc, char **argv) {
  threads_wait_asleep(argv);
  mallopt(M_MMAP_THRESHOLD, 4 << 20); /* large blocks, once freed, return to the system */
  enum status status = STATUS_OK;
  struct options *options = NULL;
  struct request request;
  bool done = false;
  TRY(options_parse(&ct2model_options, argc, argv, &options, &done));
  if (done) goto cleanup;
  if (strcmp(options_command(options), "export") == 0) {
    TRY(run_export(options));
    goto cleanup;
  }
  TRY(request_parse(options, &request));
  if (strcmp(options_command(options), "info") == 0)
    TRY(describe_files(options, &request));
  else
    TRY(run_pipeline(options, &request));
cleanup:
  if (status == STATUS_OK) status = output_flush();
  if (status != STATUS_OK) log_pending_error();
  options_free(options);
  return (int)status;
}
