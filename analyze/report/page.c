#include "analyze/report/page.h"

#include <stdlib.h>
#include <string.h>

#include "analyze/compatible_runs.h"
#include "analyze/plot.h"
#include "analyze/report/page_internal.h"
#include "analyze/report/page_methods.h"
#include "analyze/report/page_record.h"
#include "analyze/report/page_verdict.h"
#include "common/json_number.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/page_encode.h"
#include "common/provenance.h"

#define ASSETS                                                                                     \
  ASSET(page, "page.html")                                                                         \
  ASSET(style, "page.css")                                                                         \
  ASSET(charts, "page_charts.js")                                                                  \
  ASSET(maps, "page_maps.js")                                                                      \
  ASSET(scan, "page_scan.js")                                                                      \
  ASSET(solid, "page_solid.js")                                                                    \
  ASSET(script, "page.js")                                                                         \
  ASSET(dygraph, "dygraph.min.js")                                                                 \
  ASSET(dygraph_style, "dygraph.min.css")                                                          \
  ASSET(three, "three.min.js")                                                                     \
  ASSET(orbit, "OrbitControls.js")
#include "common/page_assets.h"

/* What a run, a model or a solute states about itself. */
static enum status add_file(const char *name, const char *path, const char *const *groups,
                            size_t count, json_t *list) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  json_t *object = json_pack("{s:o,s:o}", "name", json_text(name), "path", json_text(path));
  json_array_append_new(list, object);
  TRY(h5_open(path, &file));
  TRY(record_groups(file, groups, count, object));
cleanup:
  h5_close(file);
  return status;
}

static enum status add_files(struct page *page) {
  enum status status = STATUS_OK;
  static const char *const OF_RUN[] = {"/run",         "/run/error",  "/run/levels",
                                       "/run/effects", "/run/ledger", "/run/micro",
                                       "/run/regions", "/run/planes", "/provenance"};
  static const char *const OF_MODEL[] = {"/model", "/calibration", "/scanner", "/quality",
                                         "/provenance"};
  static const char *const OF_SOLUTE[] = {"/run", "/solute", "/provenance"};
  const struct subject *subject = &page->subject;
  json_t *runs = json_array(), *models = json_array(), *solutes = json_array();
  json_object_set_new(page->data, "runs", runs);
  json_object_set_new(page->data, "models", models);
  json_object_set_new(page->data, "solutes", solutes);
  for (size_t i = 0; i < subject->n; i++) {
    const struct run *run = &subject->runs[i];
    TRY(add_file(run->name, run->path, OF_RUN, sizeof OF_RUN / sizeof *OF_RUN, runs));
    json_object_set_new(json_array_get(runs, i), "has_k", json_boolean(i < subject->permeable));
    json_object_set_new(json_array_get(runs, i), "driven", json_boolean(run_has_permeability(run)));
  }
  if (page->model.found)
    TRY(add_file("model", page->model.path, OF_MODEL, sizeof OF_MODEL / sizeof *OF_MODEL, models));
  for (size_t i = 0; i < subject->solute_count; i++)
    TRY(add_file("solute", subject->solutes[i], OF_SOLUTE, sizeof OF_SOLUTE / sizeof *OF_SOLUTE,
                 solutes));
cleanup:
  return status;
}

/* The sections of analyses, with their charts, or the picture of those without. */
static void add_sections(struct page *page) {
  json_t *sections = json_array();
  for (size_t i = 0; i < ANALYSES; i++) {
    const struct analysis *analysis = analyses[i];
    const struct product *product = &page->parts[i].product;
    char *svg = NULL;
    if (!page->parts[i].there || !page->parts[i].shown) continue;
    json_t *section =
        json_pack("{s:s,s:s,s:s,s:s,s:o}", "name", analysis->name, "heading", analysis->heading,
                  "contents", analysis->contents != NULL ? analysis->contents : analysis->heading,
                  "caption", analysis->caption, "summary", json_text(product->summary.data));
    json_array_append_new(sections, section);
    if (json_array_size(product->charts) > 0) json_object_set(section, "charts", product->charts);
    if (json_array_size(product->charts) > 0 || product->width == 0) continue;
    if (plot_svg(analysis->name, product->plot.data, product->width, product->height, &svg) ==
        STATUS_OK) {
      json_object_set_new(section, "width", json_integer(product->width));
      json_object_set_new(section, "height", json_integer(product->height));
      json_object_set_new(section, "svg", encode_bytes(svg, strlen(svg)));
    } else {
      log_warning("%s", error_message());
      error_clear();
    }
    memory_free(&svg);
  }
  json_object_set_new(page->data, "sections", sections);
}

static enum status add_methods(struct page *page) {
  enum status status = STATUS_OK;
  const json_t *converge = page_found(page, &converge_analysis), *series;
  const json_t *result = json_array_get(json_object_get(page->data, "verdict"), 0);
  const char *from = json_string_value(
      json_object_get(json_object_get(result, "error_budget"), "resolution_from"));
  struct methods_facts facts = {.permeable = result != NULL,
                                .fitted = page->parts[ANALYSIS_darcy].shown,
                                .index = from != NULL && from[0] == 'g',
                                .lattices = from != NULL && from[0] == 'l'};
  json_t *methods = NULL;
  size_t i;
  json_array_foreach(json_object_get(converge, "series"), i, series) {
    facts.extrapolated |= facts.index && json_is_true(json_object_get(series, "extrapolated"));
  }
  for (i = 0; i < page->subject.n; i++)
    facts.averaged |= strcmp(page->subject.runs[i].method, "stokes") != 0;
  TRY(page_methods(&page->subject, &page->model, &facts, &methods));
  json_object_set_new(page->data, "methods", methods);
cleanup:
  return status;
}

static enum status collect(struct page *page) {
  enum status status = STATUS_OK;
  const struct run *runs = page->subject.runs;
  json_object_set_new(page->data, "title", json_text(runs[0].title));
  json_object_set_new(page->data, "version", json_string(TOSUI_VERSION));
  json_object_set_new(page->data, "command_line", json_text(page->command_line));
  json_object_set_new(page->data, "model", page_model_json(&page->model));
  /* Velocities times this carry the flow of k. */
  json_put_number(page->data, "velocity_scale", lattice_note_scale(&runs[0]));
  json_t *results = verdict_results(runs, page->subject.n, page_found(page, &darcy_analysis),
                                    page_found(page, &converge_analysis));
  json_object_set_new(page->data, "verdict", results);
  verdict_judge(results, &runs[0], &page->model);
  TRY(verdict_headline(page->data, &page->subject));
  TRY(add_methods(page));
  TRY(add_files(page));
  add_sections(page);
cleanup:
  return status;
}

/* The library of three dimensions is left out of a page that has none. */
static enum status write_page(const struct page *page, const char *path) {
  struct asset assets[] = {ASSETS};
  const bool solid = json_object_get(json_object_get(page->data, "pictures"), "flow") != NULL;
  size_t missing = 0;
  for (size_t i = 0; i < sizeof assets / sizeof *assets; i++) {
    const bool three = strcmp(assets[i].name, "three.min.js") == 0;
    missing += assets[i].size == 0;
    if (!solid && (three || strcmp(assets[i].name, "OrbitControls.js") == 0)) assets[i].size = 0;
  }
  if (missing > 0)
    log_warning("this program was built without libjs-dygraphs or libjs-three: the report has no "
                "curves or no view in three dimensions; install both and build again");
  return page_write(path, assets, sizeof assets / sizeof *assets, page->data);
}

/* Reads the model once for the whole page; if that fails the page omits what needs it. */
static void read_voxels(struct page *page) {
  const struct run *run = &page->subject.runs[0];
  page_model_read(run, &page->model);
  if (page->model.found) {
    if (model_read(page->model.path, &page->voxels) == STATUS_OK) return;
    page->model.found = false;
    log_warning("%s; the report leaves the specimen out", error_message());
    error_clear();
  } else if (page->model.named && !page->model.other) {
    log_warning("%s: the model file %s is not found; the report leaves the specimen out (put it "
                "beside the run)",
                run->path, run->model_path);
  }
}

enum status report_write(const struct run *runs, size_t n, const char *const *solutes,
                         size_t solute_count, const char *path, const char *command_line,
                         json_t **json) {
  enum status status = STATUS_OK;
  struct page page = {.subject = {.solutes = solutes, .solute_count = solute_count},
                      .command_line = command_line};
  struct run *ordered = NULL;
  page.data = json_object();
  if (page.data == NULL) TRY_FAIL(STATUS_RUN, "out of memory for the report");
  TRY(memory_allocate(&ordered, n, sizeof *ordered, "runs"));
  TRY(page_order(runs, n, ordered, &page.subject));
  read_voxels(&page);
  TRY(page_pictures(&page));
  TRY(page_analyse(&page));
  TRY(collect(&page));
  TRY(write_page(&page, path));
  json_object_del(page.data, "pictures");
  *json = json_incref(page.data);
cleanup:
  memory_free(&ordered);
  json_decref(page.data);
  for (size_t i = 0; i < ANALYSES; i++) product_free(&page.parts[i].product);
  model_free(&page.voxels);
  return status;
}
