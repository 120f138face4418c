#include "analyze/report/page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analyze/report/page_assets.h"
#include "analyze/report/page_html.h"
#include "analyze/report/page_internal.h"
#include "analyze/report/page_budget.h"
#include "analyze/report/page_methods.h"
#include "analyze/report/page_record.h"
#include "analyze/report/page_specimen.h"
#include "analyze/report/page_verdict.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/provenance.h"

static void write_asset(FILE *out, enum asset_name name, const char *open, const char *close) {
  struct asset asset = asset_get(name);
  if (asset.size == 0) return;
  fputs(open, out);
  if (strstr(close, "script") != NULL)
    html_script(out, asset.data, asset.size);
  else
    fwrite(asset.data, 1, asset.size, out);
  fputs(close, out);
}

static enum status write_data(struct page *page) {
  FILE *out = page->out;
  char *text = json_dumps(page->data, JSON_COMPACT | JSON_REAL_PRECISION(12));
  if (text == NULL) return FAIL(STATUS_RUN, "out of memory for JSON");
  fputs("<script type=\"application/json\" id=\"data\">", out);
  html_json(out, text);
  fputs("</script>\n", out);
  free(text);
  if (page->has_flow) {
    fputs("<script type=\"application/json\" id=\"flow-data\">", out);
    flow_write_json(&page->flow, "flow", out);
    fputs("</script>\n", out);
  }
  return STATUS_OK;
}

static void write_head(struct page *page) {
  FILE *out = page->out;
  fputs("<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
        "'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:\">\n"
        "<meta name=\"generator\" content=\"" TOSUI_MARK "\">\n"
        "<meta name=\"color-scheme\" content=\"light dark\">\n<title>",
        out);
  html_text(out, page->subject.runs[0].title);
  fputs(" - Tosui report</title>\n", out);
  write_asset(out, ASSET_DYGRAPH_STYLE, "<style>", "</style>\n");
  write_asset(out, ASSET_STYLE, "<style>", "</style>\n");
  fputs("</head><body>\n<header><h1>", out);
  html_text(out, page->subject.runs[0].title);
  size_t stopped = 0;
  for (size_t i = 0; i < page->subject.n; i++)
    stopped += strcmp(page->subject.runs[i].status, "interrupted") == 0;
  fprintf(out, "</h1><p>%zu run%s", page->subject.n, page->subject.n > 1 ? "s" : "");
  if (page->subject.solute_count > 0)
    fprintf(out, " of flow, %zu of a solute in it", page->subject.solute_count);
  if (stopped > 0 && page->subject.n == 1) fputs(", interrupted", out);
  if (stopped > 0 && page->subject.n > 1) fprintf(out, ", %zu of them interrupted", stopped);
  fputs("</p></header>\n<main>\n", out);
}

static void write_foot(struct page *page) {
  /* Without the time, so that the same runs give the same page. */
  fprintf(page->out, "</main>\n<footer><p>Made by analyze of Tosui %s with <code>", TOSUI_VERSION);
  html_text(page->out, page->command_line);
  fputs("</code>. Curves: dygraphs, three dimensions: three.js (both MIT licence).</p></footer>\n",
        page->out);
}

/* Whether k of all runs with a permeability is 0, because no pore leads through. */
static bool page_is_blocked(const struct page *page) {
  return page->subject.permeable > 0 && page->subject.flowing == 0;
}

static void write_link(FILE *out, const char *id, const char *name) {
  fprintf(out, "<a href=\"#%s\">%s</a> ", id, name);
}

/* Writes the list of sections, in their order on the page. */
static void write_contents(const struct page *page, bool budget) {
  FILE *out = page->out;
  fputs("<nav>", out);
  if (page->has_flow) write_link(out, "flow", "Flow");
  if (page->subject.n == 1 && page->subject.runs[0].levels.count > 1)
    write_link(out, "levels", "Accuracy");
  if (page_has_soil(page)) write_link(out, "soil", "Soil");
  if (page_is_blocked(page)) write_link(out, "pdf", "Pore velocity");
  for (enum showing showing = SHOW_OPEN; showing >= SHOW_FOLDED; showing--)
    for (size_t i = 0; i < ANALYSES; i++)
      if (page->parts[i].there && page->parts[i].showing == showing)
        write_link(out, analyses[i]->name, analyses[i]->contents);
  write_link(out, "specimen", "Specimen");
  write_link(out, "methods", "Methods");
  write_link(out, "effects", "Effects");
  if (budget) write_link(out, "ledger", "Budget");
  write_link(out, "provenance", "Provenance");
  fputs("</nav>\n", out);
}

static enum status write_methods(struct page *page) {
  enum status status = STATUS_OK;
  const json_t *converge = page_found(page, &converge_analysis);
  const json_t *result = json_array_get(json_object_get(page->data, "verdict"), 0), *series;
  const char *from = json_string_value(
      json_object_get(json_object_get(result, "error_budget"), "resolution_from"));
  struct methods_facts facts = {.permeable = result != NULL,
                                .fitted = page->parts[ANALYSIS_darcy].showing == SHOW_OPEN,
                                .index = from != NULL && from[0] == 'g',
                                .lattices = from != NULL && from[0] == 'l'};
  size_t i;
  json_array_foreach(json_object_get(converge, "series"), i, series) {
    facts.extrapolated |= facts.index && json_is_true(json_object_get(series, "extrapolated"));
  }
  for (i = 0; i < page->subject.n; i++)
    facts.averaged |= strcmp(page->subject.runs[i].method, "stokes") != 0;
  fputs("<section id=\"methods\"><h2>Methods</h2>\n", page->out);
  TRY(page_methods(&page->subject, &page->model, &facts, page->out));
  fputs("</section>\n", page->out);
cleanup:
  return status;
}

static enum status write_body(struct page *page) {
  enum status status = STATUS_OK;
  FILE *out = page->out;
  json_t *calibration = NULL;
  bool budget;
  TRY(page_has_budget(page->subject.runs, page->subject.n, &budget));
  write_head(page);
  write_contents(page, budget);
  TRY(verdict_write(page->data, &page->subject, out));
  TRY(page_flow_section(page));
  TRY(page_levels(page));
  TRY(page_soil(page));
  if (page_is_blocked(page))
    fputs(
        "<section id=\"pdf\"><h2>Pore velocity</h2>\n<p>No pore leads through the model along the "
        "force: the water is at rest, and there is no velocity to show.</p></section>\n",
        out);
  page_analyses(page);
  fputs("<section id=\"specimen\"><h2>Specimen</h2>\n", out);
  TRY(page_specimen(&page->subject.runs[0], &page->model, &page->voxels, out, &calibration));
  if (calibration != NULL) {
    json_object_set_new(page->data, "calibration", calibration);
    TRY(page_calibration(out, calibration, &page->model));
  }
  fputs("</section>\n", out);
  TRY(write_methods(page));
  fputs("<section id=\"effects\"><h2>Effects and time</h2>\n", out);
  TRY(page_effects(&page->subject.runs[0], out));
  fputs("</section>\n", out);
  if (budget) {
    fputs("<section id=\"ledger\"><h2>Budget of momentum and energy</h2>\n<details><summary>What "
          "each effect gave the water</summary>\n",
          out);
    TRY(page_budget(page->subject.runs, page->subject.n, out));
    fputs("</details></section>\n", out);
  }
  fputs("<section id=\"provenance\"><h2>Provenance</h2>\n", out);
  for (size_t i = 0; i < page->subject.n; i++)
    TRY(page_provenance(page->subject.runs[i].name, page->subject.runs[i].path, out));
  if (page->model.found) TRY(page_provenance("model", page->model.path, out));
  for (size_t i = 0; i < page->subject.solute_count; i++)
    TRY(page_provenance("solute", page->subject.solutes[i], out));
  fputs("</section>\n", out);
  write_foot(page);
  TRY(write_data(page));
  write_asset(out, ASSET_DYGRAPH, "<script>", "</script>\n");
  if (page->has_flow && asset_get(ASSET_ORBIT).size > 0) {
    write_asset(out, ASSET_THREE, "<script>", "</script>\n");
    write_asset(out, ASSET_ORBIT, "<script>", "</script>\n");
  }
  write_asset(out, ASSET_SCRIPT, "<script>", "</script>\n");
  fputs("</body></html>\n", out);
cleanup:
  return status;
}

/* The text of the page in new memory (free). */
static enum status compose(struct page *page, char **text, size_t *size) {
  enum status status = STATUS_OK;
  free(*text);
  *text = NULL;
  page->out = open_memstream(text, size);
  if (page->out == NULL) return FAIL(STATUS_RUN, "out of memory for the report");
  status = write_body(page);
  bool bad = ferror(page->out) != 0;
  bad |= fclose(page->out) != 0;
  if (status == STATUS_OK && bad) status = FAIL(STATUS_RUN, "out of memory for the report");
  return status;
}

/* Reads the model once for the whole page; if that fails the page omits what needs it. */
static void read_voxels(const struct page_model *model, struct voxel_model *voxels) {
  if (!model->found || model_read(model->path, voxels) == STATUS_OK) return;
  log_warning("%s; the report leaves the specimen out", error_message());
  error_clear();
}

#define PAGE_LIMIT 3000000 /* bytes that mail programs and browsers handle easily */

enum status page_write(const struct run *runs, size_t n, const char *const *solutes,
                       size_t solute_count, const char *path, const char *command_line,
                       json_t **json) {
  enum status status = STATUS_OK;
  struct page page = {.subject = {.solutes = solutes, .solute_count = solute_count},
                      .command_line = command_line};
  char *text = NULL;
  struct run *ordered = NULL;
  size_t size = 0;
  bool charts = asset_get(ASSET_DYGRAPH).size > 0;
  page.data = json_object();
  if (page.data == NULL) TRY_FAIL(STATUS_RUN, "out of memory for the report");
  if (!charts || asset_get(ASSET_THREE).size == 0)
    log_warning("this program was built without libjs-dygraphs or libjs-three: the report shows "
                "still pictures; install both and build again");
  TRY(memory_allocate(&ordered, n, sizeof *ordered, "runs"));
  TRY(page_order(runs, n, ordered, &page.subject));
  runs = ordered;
  page_model_read(&runs[0], &page.model);
  read_voxels(&page.model, &page.voxels);
  TRY(page_analyse(&page));
  json_t *results = verdict_results(runs, n, page_found(&page, &darcy_analysis),
                                    page_found(&page, &converge_analysis));
  json_object_set_new(page.data, "verdict", results);
  verdict_judge(results, &runs[0], &page.model);
  TRY(compose(&page, &text, &size));
  if (size > PAGE_LIMIT && charts) {
    page.lean = true;
    TRY(compose(&page, &text, &size));
  }
  TRY(output_write(path, text, size));
  *json = json_incref(page.data);
cleanup:
  free(text);
  memory_free(&ordered);
  json_decref(page.data);
  for (size_t i = 0; i < ANALYSES; i++) product_free(&page.parts[i].product);
  flow_free(&page.flow);
  plane_free(&page.plane);
  model_free(&page.voxels);
  return status;
}
