/* The page while it is made: what was analysed, and where it is written. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_INTERNAL_H
#define TOSUI_ANALYZE_REPORT_PAGE_INTERNAL_H

#include <jansson.h>
#include <stdio.h>

#include "analyze/analysis.h"
#include "analyze/product.h"
#include "analyze/report/page_flow.h"
#include "analyze/report/page_model.h"
#include "analyze/report/page_plane.h"
#include "analyze/run_file.h"
#include "common/model_file.h"

/* An analysis that the runs support; the order is that of `analyses`. */
struct part {
  bool there;
  enum showing showing;
  struct product product;
};

struct page {
  struct subject subject;
  const char *command_line;
  struct part parts[ANALYSES];
  struct page_model model; /* of the first run */
  struct voxel_model voxels; /* what that file holds; no arrays: it could not be read */
  struct flow flow;
  bool has_flow;
  struct plane plane;
  bool lean;    /* leaves the still pictures to the charts, to stay small */
  json_t *data; /* {"darcy": .., "pdf": .., ...} as embedded */
  FILE *out;
};

/* The runs in the page's order, in `ordered` (n; the runs' own memory stays theirs): those with a
 * permeability first, that it is about; and what is known of them: page_parts.c. */
enum status page_order(const struct run *runs, size_t n, struct run *ordered,
                       struct subject *subject);
/* Runs the analyses that the runs support: page_parts.c. */
enum status page_analyse(struct page *page);
/* What an analysis found; NULL: the page does not have it. */
const json_t *page_found(const struct page *page, const struct analysis *analysis);

/* Figures: page_figures.c. A section each. Those of the analyses: first what is open, then what is
 * folded. */
void page_analyses(struct page *page);
enum status page_calibration(FILE *out, const json_t *calibration, const struct page_model *model);
enum status page_levels(struct page *page);
enum status page_flow_section(struct page *page);
/* The plot of `body` (gnuplot) as a still picture of that size in points. */
void page_still(FILE *out, const char *name, const char *body, int width, int height,
                const char *title);

/* What soil with pores below the sites does, in the first run that page has: page_soil.c. */
bool page_has_soil(const struct page *page);
enum status page_soil(struct page *page);

#endif
