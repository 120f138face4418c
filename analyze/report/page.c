#include "analyze/report/page.h"

#include <stdlib.h>
#include <string.h>

#include "analyze/analysis.h"
#include "analyze/compatible_runs.h"
#include "analyze/averaging.h"
#include "analyze/plot.h"
#include "analyze/report/page_pictures.h"
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
  ASSET(words, "page_words.js")                                                                    \
  ASSET(script, "page.js")                                                                         \
  ASSET(dygraph, "dygraph.min.js")                                                                 \
  ASSET(dygraph_style, "dygraph.min.css")                                                          \
  ASSET(three, "three.min.js")                                                                     \
  ASSET(orbit, "OrbitControls.js")
#include "common/page_assets.h"

struct page {
  struct subject subject;
  struct voxel_model voxels; /* of the first run's model; without arrays if it cannot be read */
  json_t *data;              /* as embedded */
};

/* Goes on after a failure of what the page can do without. */
static void leave_out(const char *what) {
  log_warning("%s; the report leaves %s out", error_message(), what);
  error_clear();
}

/* ---- the runs ---- */

/* Rank of a run on the page: 2 with a permeability above 0, 1 with permeability 0, 0 without one. A
 * tank that fills or sloshes is driven by gravity but has no permeability: for method isph only
 * runs whose seepage does not drift have one. */
static enum status find_rank(const struct run *run, int *rank) {
  enum status status = STATUS_OK;
  *rank = 0;
  if (!run_has_permeability(run)) return STATUS_OK;
  if (strcmp(run->method, "isph") == 0) {
    struct average average;
    TRY(average_darcy(run, &average));
    if (!average.without_drift) return STATUS_OK;
  }
  *rank = run->k == 0 ? 1 : 2;
cleanup:
  return status;
}

/* The run with the finest lattice of the first run's body. */
static size_t find_finest(const struct run *runs, size_t n) {
  size_t finest = 0;
  for (size_t i = 1; i < n; i++)
    if (runs[i].spacing[0] < 0.999 * runs[finest].spacing[0] &&
        verdict_one_body(&runs[0], &runs[i]))
      finest = i;
  return finest;
}

/* Copies the runs into `ordered` (n): those with a permeability first, and among equals the one
 * whose pictures are shown. The copies own nothing. Also sets what is known of them. */
static enum status order_runs(const struct run *runs, size_t n, struct run *ordered,
                              struct subject *subject) {
  enum status status = STATUS_OK;
  const size_t finest = find_finest(runs, n);
  int *ranks = NULL;
  size_t count = 0;
  TRY(memory_allocate(&ranks, n, sizeof *ranks, "runs"));
  for (size_t i = 0; i < n; i++) TRY(find_rank(&runs[i], &ranks[i]));
  for (int rank = 2; rank >= 0; rank--) {
    if (ranks[finest] == rank) ordered[count++] = runs[finest];
    for (size_t i = 0; i < n; i++)
      if (ranks[i] == rank && i != finest) ordered[count++] = runs[i];
    if (rank == 2) subject->flowing = count;
    if (rank == 1) subject->permeable = count;
  }
  subject->runs = ordered;
  subject->n = n;
  subject->snapshots = true;
  for (size_t i = 0; i < n; i++) subject->snapshots &= runs[i].snapshot_count > 0;
cleanup:
  memory_free(&ranks);
  return status;
}

/* ---- the files ---- */

/* Reads the model once for the whole page; without it the page omits what needs it. */
static void read_model(struct page *page) {
  const struct run *run = &page->subject.runs[0];
  const struct voxel_model *voxels = &page->voxels;
  const char *state = run->model_path[0] == '\0' ? "none"
                      : run->model_other         ? "changed"
                                                 : "missing";
  if (run->model_file[0] != '\0') {
    if (model_read(run->model_file, &page->voxels) == STATUS_OK)
      state = "found";
    else
      leave_out("the specimen");
  } else if (strcmp(state, "missing") == 0) {
    log_warning("%s: the model file %s is not found; the report leaves the specimen out (put it "
                "beside the run)",
                run->path, run->model_path);
  }
  json_t *model = json_pack("{s:s}", "state", state);
  json_object_set_new(page->data, "model", model);
  if (voxels->solid == NULL) return;
  json_object_set_new(model, "soil", json_boolean(voxels->micro_porosity != NULL));
  json_object_set_new(model, "walls",
                      json_string(voxels->wall_distance != NULL    ? "distance"
                                  : voxels->grain_fraction != NULL ? "fraction"
                                                                   : "faces"));
}

/* What a run, a model or a solute states about itself; `groups` end with NULL. */
static enum status add_file(const char *name, const char *path, const char *const *groups,
                            json_t *list) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  json_t *object = json_pack("{s:o,s:o}", "name", json_text(name), "path", json_text(path));
  json_array_append_new(list, object);
  TRY(h5_open(path, &file));
  TRY(record_groups(file, groups, object));
cleanup:
  h5_close(file);
  return status;
}

static enum status add_files(const struct page *page) {
  enum status status = STATUS_OK;
  static const char *const OF_RUN[] = {
      "/run",         "/run/error",  "/run/levels", "/run/effects", "/run/ledger", "/run/micro",
      "/run/regions", "/run/planes", "/run/tensor", "/provenance",  NULL};
  static const char *const OF_MODEL[] = {"/model",   "/calibration", "/scanner",
                                         "/quality", "/provenance",  NULL};
  static const char *const OF_SOLUTE[] = {"/run",         "/solute",     "/solute/closure",
                                          "/solute/walk", "/provenance", NULL};
  const struct subject *subject = &page->subject;
  json_t *runs = json_array(), *models = json_array(), *solutes = json_array();
  json_object_set_new(page->data, "runs", runs);
  json_object_set_new(page->data, "models", models);
  json_object_set_new(page->data, "solutes", solutes);
  for (size_t i = 0; i < subject->n; i++) {
    const struct run *run = &subject->runs[i];
    TRY(add_file(run->name, run->path, OF_RUN, runs));
    json_object_set_new(json_array_get(runs, i), "has_k", json_boolean(i < subject->permeable));
    json_object_set_new(json_array_get(runs, i), "driven", json_boolean(run_has_permeability(run)));
  }
  if (page->voxels.solid != NULL)
    TRY(add_file("model", subject->runs[0].model_file, OF_MODEL, models));
  for (size_t i = 0; i < subject->solute_count; i++)
    TRY(add_file("solute", subject->solutes[i], OF_SOLUTE, solutes));
cleanup:
  return status;
}

/* ---- the analyses ---- */

/* The section of an analysis with its charts, or the picture of one without. */
static void add_section(json_t *sections, const struct analysis *analysis,
                        const struct product *product) {
  char *svg = NULL;
  json_t *section =
      json_pack("{s:s,s:s,s:s,s:s,s:o}", "name", analysis->name, "heading", analysis->heading,
                "contents", analysis->contents != NULL ? analysis->contents : analysis->heading,
                "caption", analysis->caption, "summary", json_text(product->summary.data));
  json_array_append_new(sections, section);
  if (json_array_size(product->charts) > 0) {
    json_object_set(section, "charts", product->charts);
  } else if (product->width > 0) {
    if (plot_svg(analysis->name, product->plot.data, product->width, product->height, &svg) ==
        STATUS_OK) {
      json_object_set_new(section, "width", json_integer(product->width));
      json_object_set_new(section, "svg", encode_bytes(svg, strlen(svg)));
    } else {
      leave_out("a picture");
    }
  }
  memory_free(&svg);
}

/* The subject, restricted to the runs that the page shows for an analysis. */
static struct subject page_subject(const struct subject *subject, const struct analysis *analysis) {
  struct subject part = *subject;
  if (analysis->page_runs == OF_PERMEABLE) part.n = subject->permeable;
  if (analysis->page_runs == OF_FLOWING) part.n = subject->flowing;
  if (analysis->page_runs == OF_FIRST && subject->permeable == 0) part.n = 1;
  return part;
}

static enum status add_analysis(const struct page *page, const struct analysis *analysis,
                                json_t *sections) {
  enum status status = STATUS_OK;
  const struct subject subject = page_subject(&page->subject, analysis);
  struct product product = {0};
  bool applies;
  TRY(analysis_applies(analysis, &subject, &applies));
  if (!applies) return STATUS_OK;
  TRY(product_start(analysis->name, &product));
  TRY(analysis->analyze(&subject, NULL, &product));
  TRY(product_finish(&product));
  json_object_set(page->data, analysis->name, product.json);
  if (analysis->heading != NULL &&
      (analysis->shown == NULL || analysis->shown(&page->subject, product.json)))
    add_section(sections, analysis, &product);
cleanup:
  product_free(&product);
  if (status == STATUS_OK || !analysis->may_fail) return status;
  leave_out(analysis->name);
  return STATUS_OK;
}

static enum status add_analyses(const struct page *page) {
  enum status status = STATUS_OK;
  json_t *sections = json_array();
  json_object_set_new(page->data, "sections", sections);
  if (!page->subject.snapshots)
    log_warning("not every run has a snapshot, so the report shows no velocity distribution and no "
                "flow");
  for (size_t i = 0; i < ANALYSES; i++) TRY(add_analysis(page, analyses[i], sections));
cleanup:
  return status;
}

/* ---- the answer ---- */

static void add_answer(const struct page *page) {
  const struct run *runs = page->subject.runs;
  json_t *data = page->data;
  /* Velocities times this carry the flow of k. */
  json_put_number(data, "velocity_scale", lattice_note_scale(&runs[0]));
  json_t *results = verdict_results(runs, page->subject.n, json_object_get(data, "darcy"),
                                    json_object_get(data, "converge"));
  json_object_set_new(data, "verdict", results);
  verdict_judge(results, &runs[0], verdict_scanned_voxel(&runs[0]));
}

/* ---- the pictures ---- */

/* The first run's flow in three dimensions, and maps of a plane, but of a scene's own soil and
 * water that are shown at some times. */
static enum status add_flow(const struct page *page, json_t *pictures) {
  enum status status = STATUS_OK;
  struct particles particles = {0};
  const struct run *run = &page->subject.runs[0];
  const bool driven = page->subject.permeable > 0;
  if (!page->subject.snapshots) return STATUS_OK;
  TRY(run_last_snapshot(run, &particles));
  if (run->dimensions == 3) TRY(picture_flow(run, &particles, driven, pictures));
  const bool body = driven && page->voxels.solid != NULL;
  if (body || json_object_get(pictures, "frames") == NULL)
    TRY(picture_plane(run, &particles, &page->voxels, pictures));
cleanup:
  particles_free(&particles);
  return status;
}

static enum status add_pictures(const struct page *page) {
  const struct run *run = &page->subject.runs[0];
  json_t *pictures = json_object();
  json_object_set_new(page->data, "pictures", pictures);
  if (page->voxels.solid != NULL &&
      picture_slice(run->model_file, &page->voxels, pictures) != STATUS_OK)
    leave_out("the slice");
  if (grain_sizes(&page->voxels, page->data) != STATUS_OK) leave_out("the grain sizes");
  if (picture_frames(run, pictures) != STATUS_OK) leave_out("the pictures in time");
  return add_flow(page, pictures);
}

/* ---- the page ---- */

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

enum status report_write(const struct run *runs, size_t n, const char *const *solutes,
                         size_t solute_count, const char *path, const char *command_line,
                         json_t **json) {
  enum status status = STATUS_OK;
  struct page page = {.subject = {.solutes = solutes, .solute_count = solute_count}};
  struct run *ordered = NULL;
  page.data = json_object();
  if (page.data == NULL) TRY_FAIL(STATUS_RUN, "out of memory for the report");
  TRY(memory_allocate(&ordered, n, sizeof *ordered, "runs"));
  TRY(order_runs(runs, n, ordered, &page.subject));
  json_object_set_new(page.data, "title", json_text(ordered[0].title));
  json_object_set_new(page.data, "version", json_string(TOSUI_VERSION));
  json_object_set_new(page.data, "command_line", json_text(command_line));
  read_model(&page);
  TRY(add_pictures(&page));
  TRY(add_analyses(&page));
  add_answer(&page);
  TRY(add_files(&page));
  TRY(write_page(&page, path));
  json_object_del(page.data, "pictures");
  *json = json_incref(page.data);
cleanup:
  memory_free(&ordered);
  json_decref(page.data);
  model_free(&page.voxels);
  return status;
}
