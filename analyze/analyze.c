/* analyze: numbers, plots and a report from runs of sphsolve. */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "analyze/analysis.h"
#include "analyze/compatible_runs.h"
#include "analyze/product.h"
#include "analyze/report_command.h"
#include "analyze/run_file.h"
#include "analyze/solute_flow.h"
#include "common/error.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/threads.h"
#include "common/units.h"

/* Number of commands (those of the analyses in their order, report, terminator) and of their
 * options. */
#define COMMANDS (ANALYSES + 2)
#define ENTRIES (ANALYSES * ANALYSIS_OPTIONS + 3)

struct analyze_table {
  struct option_command commands[COMMANDS];
  struct option_entry entries[ENTRIES];
};

static void build_table(struct analyze_table *table) {
  struct option_entry mix = {"mix", 0, NULL, 0,
                             "take runs of different models together (refused without)"};
  size_t commands = 0, entries = 2;
  *table = (struct analyze_table){0};
  for (size_t i = 0; i < ANALYSES; i++) {
    const struct analysis *analysis = analyses[i];
    if (analysis->command.name == NULL) continue;
    for (size_t o = 0; o < ANALYSIS_OPTIONS && analysis->options[o].name != NULL; o++) {
      table->entries[entries] = analysis->options[o];
      table->entries[entries++].commands = 1u << commands;
    }
    if (!analysis->of_solutes && analysis->command.operands_max != 1)
      mix.commands |= 1u << commands;
    table->commands[commands++] = analysis->command;
  }
  mix.commands |= 1u << commands;
  table->commands[commands] = report_command.command;
  table->entries[0] =
      (struct option_entry){"output", 'o', "DIR", OPTION_ALL,
                            "folder for NAME.json, .csv, .svg, .png and the plot's script NAME.gp; "
                            "report: the page"};
  table->entries[1] = mix;
}

/* Whether two paths are the same file. */
static bool same_file(const char *a, const char *b) {
  struct stat of_a, of_b;
  return stat(a, &of_a) == 0 && stat(b, &of_b) == 0 && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

/* Reads the operands that are runs. `solutes`: the caller handles files of a solute itself. */
static enum status read_runs(const struct options *options, bool solutes, struct run **runs,
                             size_t *n) {
  enum status status = STATUS_OK;
  size_t count = options_operand_count(options), passed = 0;
  TRY(memory_allocate(runs, count, sizeof **runs, "runs"));
  for (size_t i = 0; i < count; i++) {
    const char *path = options_operand(options, i);
    const bool solute = count > 1 && solute_has(path, SOLUTE);
    if (solutes && solute) continue;
    if (solute || (count > 1 && run_is_companion(path))) {
      log_verbose("%s: no run but a model or a file beside a run, passed over", path);
      passed++;
      continue;
    }
    bool again = false;
    for (size_t j = 0; j < i && !again; j++) again = same_file(path, options_operand(options, j));
    if (again) {
      log_warning("%s: given twice, counted once", path);
      continue;
    }
    TRY(run_read(path, &(*runs)[*n]));
    size_t first = 0;
    while (first < *n && !run_is_copy(&(*runs)[first], &(*runs)[*n])) first++;
    if (first < *n) {
      log_warning("%s: a copy of %s, counted once", path, (*runs)[first].path);
      run_free(&(*runs)[*n]);
      continue;
    }
    (*n)++;
  }
  if (*n == 0)
    TRY_FAIL(STATUS_INPUT, "%s: none of the files is a run; give OUT.hdf of sphsolve run",
             options_operand(options, 0));
  if (passed > 0)
    log_info("%zu of %zu files are no runs but models or files beside a run: passed over", passed,
             count);
  TRY(runs_name_apart(*runs, *n));
cleanup:
  return status;
}

/* Outputs a product: on stdout as text, or as JSON unless it is part of another product's JSON
 * (`held`); with -o also as files. */
static enum status output_product(const struct options *options, struct product *product,
                                  bool in_other_json) {
  enum status status = STATUS_OK;
  const char *folder = options_text(options, "output");
  TRY(product_finish(product));
  if (folder != NULL) TRY(product_save(product, folder));
  if (options_json(options)) {
    if (!in_other_json) product_print_json(product->json);
  } else if (log_level() > LOG_QUIET) {
    fputs(product->summary.data, stdout);
    if (folder != NULL)
      printf("written: %s/%s.{json,csv%s}\n", folder, product->name,
             product->width > 0 ? ",gp,svg,png" : "");
  }
cleanup:
  return status;
}

/* Runs an analysis and those that its command also outputs: products of their own, in one JSON
 * object. */
static enum status output_analysis(const struct options *options, const struct analysis *analysis,
                                   const struct subject *subject) {
  enum status status = STATUS_OK;
  struct product product = {0}, second[ANALYSES] = {{0}};
  TRY(product_start(analysis->name, &product));
  TRY(analysis->analyze(subject, options, &product));
  for (size_t i = 0; i < ANALYSES; i++) {
    bool applies;
    if (analyses[i]->delivered_with == NULL ||
        strcmp(analyses[i]->delivered_with, analysis->name) != 0)
      continue;
    TRY(analysis_applies(analyses[i], subject, &applies));
    if (!applies) continue;
    TRY(product_start(analyses[i]->name, &second[i]));
    TRY(analyses[i]->analyze(subject, options, &second[i]));
    json_object_set(product.json, analyses[i]->name, second[i].json);
  }
  TRY(output_product(options, &product, false));
  for (size_t i = 0; i < ANALYSES; i++)
    if (second[i].name != NULL) TRY(output_product(options, &second[i], true));
  if (analysis == &darcy_analysis && !options_json(options) && log_level() > LOG_QUIET)
    report_command.print_verdict(subject->runs, subject->n, product.json);
cleanup:
  for (size_t i = 0; i < ANALYSES; i++) product_free(&second[i]);
  product_free(&product);
  return status;
}

static enum status run_command(const struct options *options) {
  enum status status = STATUS_OK;
  const struct analysis *analysis = NULL; /* NULL: the report */
  struct run *runs = NULL;
  const char **solutes = NULL;
  size_t n = 0;
  for (size_t i = 0; i < ANALYSES; i++)
    if (strcmp(options_command(options), analyses[i]->name) == 0) analysis = analyses[i];
  if (analysis != NULL && analysis->of_solutes) {
    n = options_operand_count(options);
    TRY(memory_allocate(&solutes, n, sizeof *solutes, "names of files"));
    for (size_t i = 0; i < n; i++) solutes[i] = options_operand(options, i);
    TRY(output_analysis(options, analysis,
                        &(struct subject){.solutes = solutes, .solute_count = n}));
    goto cleanup;
  }
  TRY(read_runs(options, analysis == NULL, &runs, &n));
  TRY(compatible_runs_check(runs, n, analysis == NULL || analysis->several_models,
                            options_given(options, "mix")));
  if (analysis == NULL)
    TRY(report_command.write(options, runs, n));
  else
    TRY(output_analysis(options, analysis, &(struct subject){.runs = runs, .n = n}));
cleanup:
  for (size_t i = 0; runs != NULL && i < n; i++) run_free(&runs[i]);
  memory_free(&runs);
  memory_free(&solutes);
  return status;
}

int main(int argc, char **argv) {
  threads_wait_asleep(argv);
  struct analyze_table parts;
  struct options *options = NULL;
  bool done = false;
  log_start("analyze", LOG_NORMAL);
  build_table(&parts);
  const struct option_table table = {
      "analyze", "from runs of sphsolve to permeability, distributions, plots and a report",
      parts.commands, parts.entries};
  enum status status = options_parse(&table, argc, argv, &options, &done);
  if (status == STATUS_OK && !done) status = run_command(options);
  if (status == STATUS_OK) status = output_flush();
  options_free(options);
  if (status != STATUS_OK) log_pending_error();
  return (int)status;
}
