/* Runs the analyses of the page and stores their results. */
#include <string.h>

#include "analyze/averaging.h"
#include "analyze/report/page_internal.h"
#include "common/log.h"
#include "common/memory.h"

/* The subject, restricted to the runs that the page shows for an analysis. */
static struct subject page_subject(const struct subject *subject, const struct analysis *analysis) {
  struct subject part = *subject;
  if (analysis->page_runs == OF_PERMEABLE) part.n = subject->permeable;
  if (analysis->page_runs == OF_FLOWING) part.n = subject->flowing;
  if (analysis->page_runs == OF_FIRST && subject->permeable == 0) part.n = 1;
  return part;
}

static enum status run_part(struct page *page, size_t i) {
  enum status status = STATUS_OK;
  const struct analysis *analysis = analyses[i];
  struct part *part = &page->parts[i];
  const struct subject subject = page_subject(&page->subject, analysis);
  TRY(product_start(analysis->name, &part->product));
  TRY(analysis->analyze(&subject, NULL, &part->product));
  TRY(product_finish(&part->product));
  part->there = true;
  part->shown = analysis->heading != NULL &&
                (analysis->shown == NULL || analysis->shown(&page->subject, part->product.json));
  json_object_set(page->data, analysis->name, part->product.json);
cleanup:
  return status;
}

const json_t *page_found(const struct page *page, const struct analysis *analysis) {
  for (size_t i = 0; i < ANALYSES; i++)
    if (analyses[i] == analysis && page->parts[i].there) return page->parts[i].product.json;
  return NULL;
}

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

enum status page_order(const struct run *runs, size_t n, struct run *ordered,
                       struct subject *subject) {
  enum status status = STATUS_OK;
  int *ranks = NULL;
  size_t count = 0;
  TRY(memory_allocate(&ranks, n, sizeof *ranks, "runs"));
  for (size_t i = 0; i < n; i++) TRY(find_rank(&runs[i], &ranks[i]));
  for (int rank = 2; rank >= 0; rank--) {
    for (size_t i = 0; i < n; i++)
      if (ranks[i] == rank) ordered[count++] = runs[i];
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

enum status page_analyse(struct page *page) {
  enum status status = STATUS_OK;
  if (!page->subject.snapshots)
    log_warning("not every run has a snapshot, so the report shows no velocity distribution and no "
                "flow");
  for (size_t i = 0; i < ANALYSES; i++) {
    bool applies;
    const struct subject subject = page_subject(&page->subject, analyses[i]);
    TRY(analysis_applies(analyses[i], &subject, &applies));
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
