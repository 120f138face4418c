/* analyze: from runs of sphsolve to numbers, plots and a report. */
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "analyze/converge.h"
#include "analyze/darcy.h"
#include "analyze/dispersion.h"
#include "analyze/film.h"
#include "analyze/history.h"
#include "analyze/breakthrough.h"
#include "analyze/compatible_runs.h"
#include "analyze/report/page.h"
#include "analyze/report/page_model.h"
#include "analyze/report/page_verdict.h"
#include "analyze/pdf.h"
#include "analyze/product.h"
#include "analyze/run_file.h"
#include "analyze/seepage/seepage.h"
#include "analyze/slice.h"
#include "common/error.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/threads.h"
#include "common/units.h"

enum command {
  COMMAND_DARCY,
  COMMAND_PDF,
  COMMAND_HISTORY,
  COMMAND_SLICE,
  COMMAND_CONVERGE,
  COMMAND_DISPERSION,
  COMMAND_SEEPAGE,
  COMMAND_REPORT
};
#define BIT(command) (1u << (command))

static const struct option_command commands[] = {
    {"darcy", "RUN... [-o DIR]", "permeability with its error: Darcy velocity against gradient",
     "analyze darcy dense-1G.hdf dense-5G.hdf dense-10G.hdf -o results", 1, -1},
    {"pdf", "RUN... [-o DIR]", "probability density of the pore velocity, raw and normalised",
     "analyze pdf dense-1G.hdf dense-10G.hdf -o results", 1, -1},
    {"history", "RUN... [-o DIR]", "Darcy velocity, density and gauges against time; steadiness",
     "analyze history dense-1G.hdf -o results", 1, -1},
    {"slice", "RUN [--plane x=Q] [--thickness Q] [--zoom Y0,Z0,Y1,Z1] [-o DIR]",
     "velocity vectors over the grains in a slab",
     "analyze slice dense-1G.hdf --plane x=1.4mm --thickness 0.2mm -o results", 1, 1},
    {"converge", "RUN RUN... [-o DIR]",
     "k at spacing 0 from runs at different spacings: order, grid convergence index, cost",
     "analyze converge sand-30.hdf sand-60.hdf sand-120.hdf -o results", 2, -1},
    {"dispersion", "RUN... [-o DIR]",
     "how a solute spreads along and across the flow, against the Peclet number",
     "analyze dispersion solute.hdf -o results", 1, -1},
    {"seepage", "RUN [--grain-density Q] [-o DIR]",
     "flow through soil: fluxes, heads, exit gradient and heave, forces on walls, flow net",
     "analyze seepage excavation.hdf -o results", 1, 1},
    {"report", "RUN... -o report.html", "one self-contained page of all that the runs support",
     "analyze report dense-1G.hdf dense-5G.hdf dense-10G.hdf -o report.html", 1, -1},
    {0}};

static const struct option_entry entries[] = {
    {"output", 'o', "DIR", OPTION_ALL,
     "folder for NAME.json, .csv, .svg, .png and the plot's script NAME.gp; report: the page"},
    {"mix", 0, NULL,
     OPTION_ALL & ~(BIT(COMMAND_SLICE) | BIT(COMMAND_DISPERSION) | BIT(COMMAND_SEEPAGE)),
     "take runs of different models together (refused without)"},
    {"plane", 0, "AXIS=Q", BIT(COMMAND_SLICE),
     "where: x=1.4mm, y=0.2mm, ... (the middle, across x)"},
    {"thickness", 0, "Q", BIT(COMMAND_SLICE), "of the slab (one spacing)"},
    {"zoom", 0, "Y0,Z0,Y1,Z1", BIT(COMMAND_SLICE),
     "corners of the window in the plane's two axes, e.g. 0.5mm,0.5mm,1mm,1mm"},
    {"grain-density", 0, "Q", BIT(COMMAND_SEEPAGE),
     "of the soil's grains, for the critical gradient (2650 kg/m^3)"},
    {0}};

static const struct option_table table = {
    "analyze", "from runs of sphsolve to permeability, distributions, plots and a report", commands,
    entries};

static enum status parse_plane(const struct options *options, struct slice_request *request) {
  const char *plane = options_text(options, "plane");
  if (plane == NULL) return STATUS_OK;
  if (plane[0] < 'x' || plane[0] > 'z' || plane[1] != '=')
    return FAIL(STATUS_USAGE, "--plane %s: give an axis and a place, such as x=1.4mm", plane);
  request->axis = plane[0] - 'x';
  enum status status = quantity_parse(plane + 2, DIM_LENGTH, &request->position);
  if (status != STATUS_OK) error_context(STATUS_USAGE, "--plane");
  return status == STATUS_OK ? STATUS_OK : STATUS_USAGE;
}

static enum status parse_zoom(const struct options *options, struct slice_request *request) {
  const char *zoom = options_text(options, "zoom");
  if (zoom == NULL) return STATUS_OK;
  for (int i = 0; i < 4; i++) {
    char part[64];
    size_t length = strcspn(zoom, ",");
    if (length >= sizeof part || (i < 3) != (zoom[length] == ','))
      return FAIL(STATUS_USAGE, "--zoom: give four lengths, such as 0.5mm,0.5mm,1mm,1mm");
    memcpy(part, zoom, length);
    part[length] = '\0';
    if (quantity_parse(part, DIM_LENGTH, &request->zoom[i]) != STATUS_OK)
      return error_context(STATUS_USAGE, "--zoom");
    zoom += length + (i < 3);
  }
  request->zoomed = true;
  return STATUS_OK;
}

static enum status slice_command(const struct options *options, const struct run *run,
                                 struct product *product) {
  enum status status = STATUS_OK;
  struct slice_request request = {.axis = -1, .position = NAN, .thickness = NAN};
  TRY(parse_plane(options, &request));
  TRY(parse_zoom(options, &request));
  TRY(options_quantity(options, "thickness", DIM_LENGTH, &request.thickness));
  TRY(slice_analyze(run, &request, product));
cleanup:
  return status;
}

static enum status seepage_command(const struct options *options, const struct run *run,
                                   struct product *product) {
  struct seepage_request request = {.grain_density = NAN};
  enum status status =
      options_quantity(options, "grain-density", DIM_DENSITY, &request.grain_density);
  return status == STATUS_OK ? seepage_analyze(run, &request, product) : status;
}

/* Whether two names are those of one file. */
static bool file_is(const char *a, const char *b) {
  struct stat of_a, of_b;
  return stat(a, &of_a) == 0 && stat(b, &of_b) == 0 && of_a.st_dev == of_b.st_dev &&
         of_a.st_ino == of_b.st_ino;
}

/* The operands that are runs. `solutes`: the caller shows those that hold what a solute did. */
static enum status read_runs(const struct options *options, bool solutes, struct run **runs,
                             size_t *n) {
  enum status status = STATUS_OK;
  size_t count = options_operand_count(options), passed = 0;
  TRY(memory_allocate(runs, count, sizeof **runs, "runs"));
  for (size_t i = 0; i < count; i++) {
    const char *path = options_operand(options, i);
    const bool solute = count > 1 && dispersion_is(path);
    if (solutes && solute) continue;
    if (solute || (count > 1 && run_is_companion(path))) {
      log_verbose("%s: no run but a model or a file beside a run, passed over", path);
      passed++;
      continue;
    }
    bool again = false;
    for (size_t j = 0; j < i && !again; j++) again = file_is(path, options_operand(options, j));
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

/* What k is good for, and what would make it better, as the head of the page says. */
static void print_verdict(const struct run *runs, size_t n, const json_t *darcy) {
  struct page_model model;
  json_t *results = verdict_results(runs, n, darcy, NULL);
  const json_t *first = json_array_get(results, 0);
  page_model_read(&runs[0], &model);
  verdict_judge(results, &runs[0], &model);
  if (first != NULL)
    printf("Verdict: %s. %s\n", json_string_value(json_object_get(first, "good_for")),
           json_string_value(json_object_get(first, "advice")));
  json_decref(results);
}

/* Results: to stdout as text or JSON; with -o into files as well. */
static void print_product(const struct product *product, const char *folder) {
  fputs(product->summary.data, stdout);
  if (folder != NULL) printf("written: %s/%s.{json,csv,gp,svg,png}\n", folder, product->name);
}

static enum status deliver(const struct options *options, struct product *product) {
  enum status status = STATUS_OK;
  const char *folder = options_text(options, "output");
  TRY(product_finish(product));
  if (folder != NULL) TRY(product_save(product, folder));
  if (options_json(options)) {
    json_dumpf(product->json, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
    putchar('\n');
  } else if (log_level() > LOG_QUIET) {
    print_product(product, folder);
  }
cleanup:
  return status;
}

/* One whose JSON the first holds. */
static enum status deliver_second(const struct options *options, struct product *product) {
  enum status status = STATUS_OK;
  const char *folder = options_text(options, "output");
  TRY(product_finish(product));
  if (folder != NULL) TRY(product_save(product, folder));
  if (!options_json(options) && log_level() > LOG_QUIET) print_product(product, folder);
cleanup:
  return status;
}

/* Commands on any number of runs. */
static const struct {
  const char *name;
  enum status (*analyze)(const struct run *runs, size_t n, struct product *product);
} many[] = {{"darcy", darcy_analyze},
            {"pdf", pdf_analyze},
            {"history", history_analyze},
            {"converge", converge_analyze}};

/* The operands that hold what a solute did; free with memory_free. */
static enum status find_solutes(const struct options *options, const char ***paths, size_t *n) {
  enum status status = STATUS_OK;
  const size_t count = options_operand_count(options);
  TRY(memory_allocate(paths, count, sizeof **paths, "names of files"));
  for (size_t i = 0; i < count; i++)
    if (dispersion_is(options_operand(options, i))) (*paths)[(*n)++] = options_operand(options, i);
cleanup:
  return status;
}

static enum status report_command(const struct options *options, const struct run *runs, size_t n) {
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
  TRY(page_write(runs, n, solutes, solute_count, path, options_command_line(options), &json));
  if (options_json(options)) {
    json_dumpf(json, stdout, JSON_INDENT(2) | JSON_REAL_PRECISION(12));
    putchar('\n');
  } else if (log_level() > LOG_QUIET) {
    printf("written: %s\n", path);
  }
cleanup:
  memory_free(&solutes);
  json_decref(json);
  return status;
}

/* Walks leave breakthrough curves and a film strip too: products of their own, in one JSON object. */
static enum status dispersion_command(const struct options *options) {
  enum status status = STATUS_OK;
  struct product product = {0}, curves = {0}, film = {0};
  bool walked = false, filmed = false;
  const char **paths = NULL;
  const size_t n = options_operand_count(options);
  TRY(memory_allocate(&paths, n, sizeof *paths, "names of files"));
  for (size_t i = 0; i < n; i++) paths[i] = options_operand(options, i);
  TRY(product_start("dispersion", &product));
  TRY(dispersion_analyze(paths, n, &product));
  for (size_t i = 0; i < n; i++) {
    walked = walked || breakthrough_is(paths[i]);
    filmed = filmed || film_is(paths[i]);
  }
  if (walked) {
    TRY(product_start("breakthrough", &curves));
    TRY(breakthrough_analyze(paths, n, &curves));
    json_object_set(product.json, "breakthrough", curves.json);
  }
  if (filmed) {
    TRY(product_start("film", &film));
    TRY(film_analyze(paths, n, &film));
    json_object_set(product.json, "film", film.json);
  }
  TRY(deliver(options, &product));
  if (walked) TRY(deliver_second(options, &curves));
  if (filmed) TRY(deliver_second(options, &film));
cleanup:
  memory_free(&paths);
  product_free(&curves);
  product_free(&film);
  product_free(&product);
  return status;
}

static enum status run_command(const struct options *options) {
  enum status status = STATUS_OK;
  const char *command = options_command(options);
  struct run *runs = NULL;
  struct product product = {0};
  size_t n = 0;
  if (strcmp(command, "dispersion") == 0) return dispersion_command(options);
  TRY(product_start(command, &product));
  const bool report = strcmp(command, "report") == 0;
  TRY(read_runs(options, report, &runs, &n));
  /* A study of the resolution has a model for each spacing. */
  bool levels = report || strcmp(command, "converge") == 0;
  TRY(compatible_runs_check(runs, n, levels, options_given(options, "mix")));
  if (report) {
    TRY(report_command(options, runs, n));
    goto cleanup;
  }
  if (strcmp(command, "slice") == 0) {
    TRY(slice_command(options, &runs[0], &product));
  } else if (strcmp(command, "seepage") == 0) {
    TRY(seepage_command(options, &runs[0], &product));
  } else {
    for (size_t i = 0; i < sizeof many / sizeof *many; i++)
      if (strcmp(command, many[i].name) == 0) TRY(many[i].analyze(runs, n, &product));
  }
  TRY(deliver(options, &product));
  if (!strcmp(command, "darcy") && !options_json(options) && log_level() > LOG_QUIET)
    print_verdict(runs, n, product.json);
cleanup:
  for (size_t i = 0; i < n; i++) run_free(&runs[i]);
  memory_free(&runs);
  product_free(&product);
  return status;
}

int main(int argc, char **argv) {
  threads_wait_asleep(argv);
  struct options *options = NULL;
  bool done = false;
  log_start("analyze", LOG_NORMAL);
  enum status status = options_parse(&table, argc, argv, &options, &done);
  if (status == STATUS_OK && !done) status = run_command(options);
  if (status == STATUS_OK) status = output_flush();
  options_free(options);
  if (status != STATUS_OK) log_pending_error();
  return (int)status;
}
