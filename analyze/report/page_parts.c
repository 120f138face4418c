/* Which analyses the page holds, and their results. */
#include <math.h>
#include <string.h>

#include "analyze/averaging.h"
#include "analyze/report/page_internal.h"
#include "common/log.h"

static enum status run_part(struct page *page, size_t i) {
  enum status status = STATUS_OK;
  const struct analysis *analysis = analyses[i];
  struct part *part = &page->parts[i];
  TRY(product_start(analysis->name, &part->product));
  TRY(analysis->analyze(&page->subject, NULL, &part->product));
  TRY(product_finish(&part->product));
  part->there = true;
  part->showing = analysis->heading == NULL ? SHOW_NOT
                  : analysis->showing != NULL
                      ? analysis->showing(&page->subject, part->product.json)
                      : SHOW_OPEN;
  json_object_set(page->data, analysis->name, part->product.json);
cleanup:
  return status;
}

const json_t *page_found(const struct page *page, const struct analysis *analysis) {
  for (size_t i = 0; i < ANALYSES; i++)
    if (analyses[i] == analysis && page->parts[i].there) return page->parts[i].product.json;
  return NULL;
}

/* Whether all runs have a permeability. A tank that fills or sloshes is driven by gravity and has
 * none: of method isph only runs whose seepage does not drift count. */
static enum status find_permeable(const struct run *runs, size_t n, bool *permeable) {
  enum status status = STATUS_OK;
  *permeable = true;
  for (size_t i = 0; i < n; i++) *permeable &= run_has_permeability(&runs[i]);
  for (size_t i = 0; *permeable && i < n; i++) {
    struct average average;
    if (strcmp(runs[i].method, "isph") != 0) continue;
    TRY(average_darcy(&runs[i], &average));
    *permeable = average.without_drift;
  }
cleanup:
  return status;
}

static enum status describe_subject(struct subject *subject) {
  enum status status = STATUS_OK;
  TRY(find_permeable(subject->runs, subject->n, &subject->permeable));
  subject->snapshots = true;
  for (size_t i = 0; i < subject->n; i++) {
    subject->blocked |= subject->permeable && subject->runs[i].k == 0;
    subject->snapshots &= subject->runs[i].snapshot_count > 0;
  }
cleanup:
  return status;
}

/* The first run's flow in three dimensions, and maps of a plane. */
static enum status find_flow(struct page *page) {
  enum status status = STATUS_OK;
  struct particles particles = {0};
  const struct run *run = &page->subject.runs[0];
  if (run->dimensions != 3) return STATUS_OK;
  TRY(run_last_snapshot(run, &particles));
  TRY(flow_build(run, &particles, &page->flow));
  page->has_flow = true;
  if (page->subject.permeable && page->flow.speed_high > 0.0) {
    TRY(paths_find(run, &particles, &page->flow));
    TRY(plane_read(run, &particles, &page->voxels, &page->plane));
    page->subject.maps = page->plane.speed_high > 0.0;
    json_object_set_new(
        page->data, "flow",
        json_pack("{s:o}", "pore_share_of_half_the_flow", json_number(page->flow.paths_share)));
  }
cleanup:
  particles_free(&particles);
  return status;
}

enum status page_analyse(struct page *page) {
  enum status status = STATUS_OK;
  TRY(describe_subject(&page->subject));
  if (page->subject.snapshots)
    TRY(find_flow(page));
  else
    log_warning("not every run has a snapshot, so the report shows no velocity distribution and no "
                "flow");
  for (size_t i = 0; i < ANALYSES; i++) {
    bool applies;
    TRY(analysis_applies(analyses[i], &page->subject, &applies));
    if (!applies) continue;
    status = run_part(page, i);
    if (status != STATUS_OK && !analyses[i]->may_fail) goto cleanup;
    if (status != STATUS_OK) {
      log_warning("the report goes without \"%s\": %s", analyses[i]->name, error_message());
      error_clear();
      status = STATUS_OK;
    }
  }
cleanup:
  return status;
}
