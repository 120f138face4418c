/* Which analyses the page holds, and their results. */
#include <math.h>
#include <string.h>

#include "analyze/breakthrough.h"
#include "analyze/converge.h"
#include "analyze/darcy.h"
#include "analyze/dispersion.h"
#include "analyze/film.h"
#include "analyze/history.h"
#include "analyze/pdf.h"
#include "analyze/report/page_internal.h"
#include "analyze/seepage/seepage.h"
#include "analyze/slice.h"
#include "analyze/averaging.h"
#include "common/log.h"

const char *const page_part_names[PARTS] = {"darcy",        "history",  "pdf",
                                            "slice",        "converge", "dispersion",
                                            "breakthrough", "film",     "seepage"};

/* Whether an analysis applies is decided by what runs hold, not by trying: a failure is a failure.
 */
static enum status run_part(struct page *page, enum part part) {
  enum status status = STATUS_OK;
  struct slice_request middle = {.axis = -1, .position = NAN, .thickness = NAN, .vectors = 42.0};
  struct product *product = &page->part[part];
  const struct run *first = &page->runs[0];
  TRY(product_start(page_part_names[part], product));
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
  case PART_SEEPAGE:
    TRY(seepage_analyze(first, &(struct seepage_request){NAN}, product));
    break;
  case PART_DISPERSION:
    TRY(dispersion_analyze(page->solutes, page->solute_count, product));
    break;
  case PART_FILM:
    TRY(film_analyze(page->solutes, page->solute_count, product));
    break;
  case PART_BREAKTHROUGH:
    TRY(breakthrough_analyze(page->solutes, page->solute_count, product));
    break;
  default:
    TRY(converge_analyze(page->runs, page->n, product));
    break;
  }
  TRY(product_finish(product));
  json_object_set(page->data, page_part_names[part], product->json);
cleanup:
  return status;
}

static bool all_driven(const struct page *page) {
  for (size_t i = 0; i < page->n; i++)
    if (!run_has_permeability(&page->runs[i])) return false;
  return true;
}

/* A tank that fills or sloshes is driven by gravity and has no permeability: of method isph only
 * runs whose seepage does not drift count. */
static enum status seeps(const struct page *page, bool *result) {
  enum status status = STATUS_OK;
  *result = all_driven(page);
  for (size_t i = 0; *result && i < page->n; i++) {
    struct average average;
    if (strcmp(page->runs[i].method, "isph") != 0) continue;
    TRY(average_darcy(&page->runs[i], &average));
    *result = average.without_drift;
  }
cleanup:
  return status;
}

/* Whether nothing leads through a model: its water is at rest, and has no distribution of
 * velocities. */
static bool any_blocked(const struct page *page) {
  for (size_t i = 0; i < page->n; i++)
    if (page->runs[i].k == 0) return true;
  return false;
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

enum status page_analyse(struct page *page) {
  enum status status = STATUS_OK;
  struct particles particles = {0};
  bool permeable, net = false;
  TRY(seeps(page, &permeable));
  if (permeable) TRY(run_part(page, PART_DARCY));
  TRY(run_part(page, PART_HISTORY));
  if (page->solute_count > 0) TRY(run_part(page, PART_DISPERSION));
  for (size_t i = 0; i < page->solute_count && !page->has[PART_BREAKTHROUGH]; i++)
    if (breakthrough_is(page->solutes[i])) TRY(run_part(page, PART_BREAKTHROUGH));
  for (size_t i = 0; i < page->solute_count && !page->has[PART_FILM]; i++)
    if (film_is(page->solutes[i])) TRY(run_part(page, PART_FILM));
  page->blocked = permeable && any_blocked(page);
  if (all_have_snapshots(page)) {
    if (permeable && !page->blocked) TRY(run_part(page, PART_PDF));
    if (!page->blocked) TRY(run_part(page, PART_SLICE));
    if (page->n == 1) TRY(seepage_applies(&page->runs[0], &net));
    if (net) TRY(run_part(page, PART_SEEPAGE));
    TRY(run_last_snapshot(&page->runs[0], &particles));
    if (page->runs[0].dimensions == 3) {
      TRY(flow_build(&page->runs[0], &particles, &page->flow));
      page->has_flow = true;
      if (permeable && page->flow.speed_high > 0.0) {
        TRY(plume_find(&page->runs[0], &particles, &page->flow));
        TRY(plane_read(&page->runs[0], &particles, &page->model, &page->plane));
        page->has_plane = page->plane.speed_high > 0.0;
        json_object_set_new(
            page->data, "flow",
            json_pack("{s:o}", "pore_share_of_half_the_flow", json_number(page->flow.plume_share)));
      }
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
