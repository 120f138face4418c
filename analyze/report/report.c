/* The report: a page of what runs support. */
#include <limits.h>
#include <stdio.h>

#include "analyze/product.h"
#include "analyze/report/page.h"
#include "analyze/report/page_verdict.h"
#include "analyze/report_command.h"
#include "analyze/solute_flow.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "common/output_guard.h"

/* Prints the assessment of k and the advice as at the head of the page; with several results that
 * of the first, with its name. */
static void print_verdict(const struct run *runs, size_t n, const json_t *darcy) {
  json_t *results = verdict_results(runs, n, darcy, NULL);
  const json_t *first = json_array_get(results, 0);
  verdict_judge(results, &runs[0], verdict_scanned_voxel(&runs[0]));
  if (first != NULL) {
    if (json_array_size(results) == 1)
      fputs("Verdict", stdout);
    else
      printf("Verdict of %s, %s", json_string_value(json_object_get(first, "path")),
             json_string_value(json_object_get(first, "name")));
    printf(": %s. %s\n", json_string_value(json_object_get(first, "good_for")),
           json_string_value(json_object_get(first, "advice")));
  }
  json_decref(results);
}

/* The operands that are files of a solute; free with memory_free. */
static enum status find_solutes(const struct options *options, const char ***paths, size_t *n) {
  enum status status = STATUS_OK;
  const size_t count = options_operand_count(options);
  TRY(memory_allocate(paths, count, sizeof **paths, "names of files"));
  for (size_t i = 0; i < count; i++)
    if (solute_has(options_operand(options, i), SOLUTE))
      (*paths)[(*n)++] = options_operand(options, i);
cleanup:
  return status;
}

static enum status write_report(const struct options *options, const struct run *runs, size_t n) {
  enum status status = STATUS_OK;
  json_t *json = NULL;
  const char **solutes = NULL;
  size_t solute_count = 0;
  static const char *const ENDINGS[] = {".html", ".htm", NULL};
  const char *given = options_text(options, "output");
  char path[PATH_MAX];
  if (given == NULL || given[0] == '\0')
    TRY_FAIL(STATUS_USAGE, "report: name the page with -o report.html");
  TRY(output_name(given, ENDINGS, "a page is HTML (a browser prints it to PDF)", path,
                  sizeof path));
  TRY(output_allow(path));
  TRY(find_solutes(options, &solutes, &solute_count));
  TRY(solute_flow_check(solutes, solute_count, runs, n, options_given(options, "mix")));
  TRY(report_write(runs, n, solutes, solute_count, path, options_command_line(options), &json));
  if (options_json(options)) {
    product_print_json(json);
  } else if (log_level() > LOG_QUIET) {
    printf("written: %s\n", path);
  }
cleanup:
  memory_free(&solutes);
  json_decref(json);
  return status;
}

const struct report_command report_command = {
    .command = {"report", "RUN... -o report.html",
                "one self-contained page of all that the runs support",
                "analyze report dense-1G.hdf dense-5G.hdf dense-10G.hdf -o report.html", 1, -1},
    .write = write_report,
    .print_verdict = print_verdict};
