#include "analyze/report/page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analyze/converge.h"
#include "analyze/darcy.h"
#include "analyze/history.h"
#include "analyze/report/page_assets.h"
#include "analyze/report/page_flow.h"
#include "analyze/report/page_html.h"
#include "analyze/report/page_ledger.h"
#include "analyze/report/page_methods.h"
#include "analyze/report/page_model.h"
#include "analyze/report/page_record.h"
#include "analyze/report/page_specimen.h"
#include "analyze/report/page_verdict.h"
#include "analyze/pdf.h"
#include "analyze/plot.h"
#include "analyze/slice.h"
#include "analyze/steady.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/provenance.h"

/* The analyses, each present or not as the runs support it. */
enum part { PART_DARCY, PART_HISTORY, PART_PDF, PART_SLICE, PART_CONVERGE, PARTS };
static const char *const part_names[PARTS] = {"darcy", "history", "pdf", "slice", "converge"};

struct page {
  const struct run *runs;
  size_t n;
  const char *command_line;
  bool has[PARTS];
  struct product part[PARTS];
  struct page_model model; /* of the first run */
  struct flow flow;
  bool has_flow;
  bool lean;    /* leaves the still pictures to the charts, to stay small */
  json_t *data; /* {"darcy": .., "pdf": .., ...} as embedded */
  FILE *out;
};

/* Whether an analysis applies is decided by what runs hold, not by trying: a failure is a failure.
 */
static enum status run_part(struct page *page, enum part part) {
  enum status status = STATUS_OK;
  struct slice_request middle = {.axis = -1, .position = NAN, .thickness = NAN, .vectors = 42.0};
  struct product *product = &page->part[part];
  const struct run *first = &page->runs[0];
  TRY(product_start(part_names[part], product));
  page->has[part] = true;
  switch (part) {
  case PART_DARCY:
    TRY(darcy_analyze(page->runs, page->n, product));
    break;
  case PART_HISTORY:
    TRY(history_analyze(page->runs, page->n, product));
    break;
  case PART_PDF:
    TRY(pdf_analyze(page->runs, page->n, product));
    break;
  case PART_SLICE:
    TRY(slice_analyze(first, &middle, product));
    break;
  default:
    TRY(converge_analyze(page->runs, page->n, product));
    break;
  }
  TRY(product_finish(product));
  json_object_set(page->data, part_names[part], product->json);
cleanup:
  return status;
}

static bool all_driven(const struct page *page) {
  for (size_t i = 0; i < page->n; i++)
    if (!run_has_permeability(&page->runs[i])) return false;
  return true;
}

/* A tank that fills or sloshes is driven by gravity and has no permeability: of method isph only
 * runs with a steady seepage count. */
static enum status seeps(const struct page *page, bool *result) {
  enum status status = STATUS_OK;
  *result = all_driven(page);
  for (size_t i = 0; *result && i < page->n; i++) {
    struct steady steady;
    if (strcmp(page->runs[i].method, "isph") != 0) continue;
    TRY(steady_darcy(&page->runs[i], &steady));
    *result = steady.is_steady;
  }
cleanup:
  return status;
}

static bool all_have_snapshots(const struct page *page) {
  for (size_t i = 0; i < page->n; i++)
    if (page->runs[i].snapshot_count == 0) return false;
  return true;
}

static bool spacings_differ(const struct page *page) {
  for (size_t i = 1; i < page->n; i++)
    if (fabs(page->runs[i].spacing[0] / page->runs[0].spacing[0] - 1.0) > 1e-4) return true;
  return false;
}

static enum status run_parts(struct page *page) {
  enum status status = STATUS_OK;
  struct particles particles = {0};
  bool permeable;
  TRY(seeps(page, &permeable));
  if (permeable) TRY(run_part(page, PART_DARCY));
  TRY(run_part(page, PART_HISTORY));
  if (all_have_snapshots(page)) {
    if (permeable) TRY(run_part(page, PART_PDF));
    TRY(run_part(page, PART_SLICE));
    TRY(run_last_snapshot(&page->runs[0], &particles));
    if (page->runs[0].dimensions == 3) {
      TRY(flow_build(&page->runs[0], &particles, &page->flow));
      page->has_flow = true;
    }
  } else {
    log_warning("not every run has a snapshot, so the report shows no velocity distribution and no "
                "flow");
  }
  if (permeable && spacings_differ(page)) {
    /* Runs of one scan at several spacings, or of different bodies: then nothing is extrapolated.
     */
    if (run_part(page, PART_CONVERGE) != STATUS_OK) {
      log_warning("no extrapolation over spacings: %s", error_message());
      error_clear();
      page->has[PART_CONVERGE] = false;
    }
  }
cleanup:
  particles_free(&particles);
  return status;
}

/* ---- writing ---- */

/* The plot of `body` as a still picture; a page without one is better than no page. */
static void write_still(FILE *out, const char *name, const char *body, int width, int height,
                        const char *title) {
  char *svg = NULL;
  if (plot_svg(name, body, width, height, &svg) != STATUS_OK) {
    log_warning("%s", error_message());
    error_clear();
  }
  if (svg != NULL) {
    fprintf(out,
            "<img class=\"still\" data-name=\"%s\" width=\"%d\" height=\"%d\" alt=\"%s\" "
            "src=\"data:image/svg+xml;base64,",
            name, width, height, title);
    html_base64(out, svg, strlen(svg));
    fputs("\">\n", out);
  } else {
    fputs("<p class=\"still\">No still picture: gnuplot did not draw it when the page was "
          "made.</p>\n",
          out);
  }
  memory_free(&svg);
}

/* Whether a part deserves the reader's screen: a line through one point and a record of a few rows
 * do not; they wait behind a fold. */
static bool is_worth_a_screen(const struct page *page, enum part part) {
  size_t i;
  const json_t *group, *json = page->part[part].json;
  if (part == PART_DARCY) {
    json_array_foreach(json_object_get(json, "groups"), i, group) {
      if (json_array_size(json_object_get(group, "runs")) > 1) return true;
    }
    return false;
  }
  if (part == PART_HISTORY) {
    for (i = 0; i < page->n; i++)
      if (page->runs[i].column_count > 0 && page->runs[i].columns[0].rows >= 10 &&
          strcmp(page->runs[i].method, "stokes") != 0)
        return true;
    return false;
  }
  return true;
}

/* A figure: live charts (drawn by page.js into .charts) with the plot as still picture beside. */
static void write_figure(struct page *page, enum part part, const char *title,
                         const char *caption) {
  FILE *out = page->out;
  const struct product *product = &page->part[part];
  if (!page->has[part]) return;
  const bool shown = is_worth_a_screen(page, part);
  fprintf(out, "<section id=\"%s\"><h2>%s</h2>\n%s<figure>", part_names[part], title,
          shown ? "" : "<details><summary>One value a run: show the figure</summary>");
  if (part != PART_SLICE)
    fprintf(out, "<div class=\"charts\" data-part=\"%s\"></div>\n", part_names[part]);
  if (!page->lean || part == PART_SLICE)
    write_still(out, part_names[part], product->plot.data, product->width, product->height, title);
  fprintf(out, "<figcaption>%s</figcaption></figure>\n<pre class=\"summary\">", caption);
  html_text(out, product->summary.data);
  fprintf(out, "</pre>%s</section>\n", shown ? "" : "</details>");
}

static enum status write_calibration(FILE *out, const json_t *calibration,
                                     const struct page_model *model) {
  enum status status = STATUS_OK;
  char *body = NULL;
  size_t size = 0;
  FILE *plot = open_memstream(&body, &size);
  if (plot == NULL) return FAIL(STATUS_RUN, "out of memory for a plot");
  page_calibration_plot(calibration, plot);
  if (fclose(plot) != 0) TRY_FAIL(STATUS_RUN, "out of memory for a plot");
  fputs("<figure><div class=\"charts\" data-part=\"calibration\"></div>", out);
  write_still(out, "calibration", body, 1200, 480, "Calibration of the threshold");
  fprintf(out,
          "<figcaption>Void ratio against the grey threshold, and the histogram of grey values; at "
          "the resolution of the model and of the scan. Dashed: the model&rsquo;s threshold%s."
          "</figcaption></figure>\n",
          model->rule == RULE_MATCHED ? " and the measured void ratio that it was set to give"
          : isfinite(model->void_ratio_measured)
              ? " and the measured void ratio, which it was not set to give"
              : "");
cleanup:
  free(body);
  return status;
}

static enum status write_flow(struct page *page) {
  enum status status = STATUS_OK;
  FILE *out = page->out;
  if (!page->has_flow) return STATUS_OK;
  fputs("<section id=\"flow\"><h2>Grains and flow</h2>\n<figure><div id=\"view\"><div "
        "class=\"still3d\">",
        out);
  TRY(flow_write_still(&page->flow, out));
  fputs("</div></div>\n<figcaption>Grains and streamlines of <em>", out);
  html_text(out, page->runs[0].name);
  fprintf(
      out,
      "</em>, coloured by speed from 0 (light) to %.3g mm/s (dark). Drag to turn, wheel or pinch "
      "to zoom; the slider cuts the grains.</figcaption></figure></section>\n",
      1e3 * page->flow.speed_high);
cleanup:
  return status;
}

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
  html_text(out, page->runs[0].title);
  fputs(" - Tosui report</title>\n", out);
  write_asset(out, ASSET_DYGRAPH_STYLE, "<style>", "</style>\n");
  write_asset(out, ASSET_STYLE, "<style>", "</style>\n");
  fputs("</head><body>\n<header><h1>", out);
  html_text(out, page->runs[0].title);
  fprintf(out, "</h1><p>%zu run%s</p></header>\n<main>\n", page->n, page->n > 1 ? "s" : "");
}

static void write_foot(struct page *page) {
  /* Without the time: the same runs give the same page. */
  fprintf(page->out, "</main>\n<footer><p>Made by analyze of Tosui %s with <code>", TOSUI_VERSION);
  html_text(page->out, page->command_line);
  fputs("</code>. Curves: dygraphs, three dimensions: three.js (both MIT licence).</p></footer>\n",
        page->out);
}

static void write_contents(const struct page *page, bool ledger) {
  const struct {
    const char *id, *name;
    bool there;
  } list[] = {{"flow", "Flow", page->has_flow},
              {"converge", "Accuracy", page->has[PART_CONVERGE]},
              {"pdf", "Pore velocity", page->has[PART_PDF]},
              {"darcy", "Darcy&rsquo;s law", page->has[PART_DARCY]},
              {"history", "History", page->has[PART_HISTORY]},
              {"slice", "Slice", page->has[PART_SLICE]},
              {"specimen", "Specimen", true},
              {"methods", "Methods", true},
              {"effects", "Effects", true},
              {"ledger", "Budget", ledger},
              {"provenance", "Provenance", true}};
  fputs("<nav>", page->out);
  for (size_t i = 0; i < sizeof list / sizeof *list; i++)
    if (list[i].there) fprintf(page->out, "<a href=\"#%s\">%s</a> ", list[i].id, list[i].name);
  fputs("</nav>\n", page->out);
}

static void write_methods(struct page *page) {
  const json_t *converge = page->has[PART_CONVERGE] ? page->part[PART_CONVERGE].json : NULL;
  const json_t *result = json_array_get(json_object_get(page->data, "verdict"), 0), *series;
  const char *from = json_string_value(
      json_object_get(json_object_get(result, "error_budget"), "resolution_from"));
  struct methods_facts facts = {.permeable = result != NULL,
                                .fitted =
                                    page->has[PART_DARCY] && is_worth_a_screen(page, PART_DARCY),
                                .index = from != NULL && from[0] == 'g'};
  size_t i;
  json_array_foreach(json_object_get(converge, "series"), i, series) {
    facts.extrapolated |= json_is_true(json_object_get(series, "extrapolated"));
  }
  for (i = 0; i < page->n; i++) facts.averaged |= strcmp(page->runs[i].method, "stokes") != 0;
  fputs("<section id=\"methods\"><h2>Methods</h2>\n", page->out);
  page_methods(page->runs, page->n, &page->model, &facts, page->out);
  fputs("</section>\n", page->out);
}

static enum status write_body(struct page *page) {
  enum status status = STATUS_OK;
  FILE *out = page->out;
  json_t *calibration = NULL;
  bool ledger;
  TRY(page_has_ledger(page->runs, page->n, &ledger));
  write_head(page);
  write_contents(page, ledger);
  verdict_write(json_object_get(page->data, "verdict"), out);
  TRY(write_flow(page));
  write_figure(page, PART_CONVERGE, "Accuracy and its cost",
               "k against spacing with the extrapolation, and its deviation from the "
               "extrapolated k against wall-clock time.");
  write_figure(page, PART_PDF, "Pore velocity",
               "Probability density of the velocity along the driving force, raw and over the "
               "pore mean, with those of a slit, a tube, an exponential and a fitted "
               "power-exponential.");
  write_figure(page, PART_DARCY, "Darcy&rsquo;s law",
               "Darcy velocity against hydraulic gradient with the fitted line.");
  write_figure(page, PART_HISTORY, "History",
               "Darcy velocity and density against time, the density's histogram at the end, and "
               "what the scene records.");
  write_figure(page, PART_SLICE, "Slice",
               "Velocity in the plane over the grains (grey), half-way through the body.");
  fputs("<section id=\"specimen\"><h2>Specimen</h2>\n", out);
  TRY(page_specimen(&page->runs[0], &page->model, out, &calibration));
  if (calibration != NULL) {
    json_object_set_new(page->data, "calibration", calibration);
    TRY(write_calibration(out, calibration, &page->model));
  }
  fputs("</section>\n", out);
  write_methods(page);
  fputs("<section id=\"effects\"><h2>Effects and time</h2>\n", out);
  TRY(page_effects(&page->runs[0], out));
  fputs("</section>\n", out);
  if (ledger) {
    fputs("<section id=\"ledger\"><h2>Budget of momentum and energy</h2>\n<details><summary>What "
          "each effect gave the water</summary>\n",
          out);
    TRY(page_ledger(page->runs, page->n, out));
    fputs("</details></section>\n", out);
  }
  fputs("<section id=\"provenance\"><h2>Provenance</h2>\n", out);
  for (size_t i = 0; i < page->n; i++) TRY(page_provenance(&page->runs[i], out));
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

/* The page's text in new memory (free). */
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

#define PAGE_LIMIT 3000000 /* bytes; mail and browsers take it without thinking */

enum status page_write(const struct run *runs, size_t n, const char *path, const char *command_line,
                       json_t **json) {
  enum status status = STATUS_OK;
  struct page page = {.runs = runs, .n = n, .command_line = command_line};
  char *text = NULL;
  size_t size = 0;
  bool charts = asset_get(ASSET_DYGRAPH).size > 0;
  page.data = json_object();
  if (page.data == NULL) TRY_FAIL(STATUS_RUN, "out of memory for the report");
  if (!charts || asset_get(ASSET_THREE).size == 0)
    log_warning("this program was built without libjs-dygraphs or libjs-three: the report shows "
                "still pictures; install both and build again");
  TRY(run_parts(&page));
  page_model_read(&runs[0], &page.model);
  json_t *results =
      verdict_results(runs, n, page.has[PART_DARCY] ? page.part[PART_DARCY].json : NULL,
                      page.has[PART_CONVERGE] ? page.part[PART_CONVERGE].json : NULL);
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
  json_decref(page.data);
  for (int i = 0; i < PARTS; i++) product_free(&page.part[i]);
  flow_free(&page.flow);
  return status;
}
