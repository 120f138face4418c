/* The page while it is made: what was analysed, and where it is written. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_INTERNAL_H
#define TOSUI_ANALYZE_REPORT_PAGE_INTERNAL_H

#include <jansson.h>
#include <stdio.h>

#include "analyze/product.h"
#include "analyze/report/page_flow.h"
#include "analyze/report/page_model.h"
#include "analyze/report/page_plane.h"
#include "analyze/run_file.h"

/* The analyses, each present or not as the runs support it. */
enum part {
  PART_DARCY,
  PART_HISTORY,
  PART_PDF,
  PART_SLICE,
  PART_CONVERGE,
  PART_DISPERSION,
  PART_BREAKTHROUGH,
  PART_FILM,
  PART_SEEPAGE,
  PARTS
};

struct page {
  const struct run *runs;
  size_t n;
  const char *const *solutes;
  size_t solute_count;
  const char *command_line;
  bool has[PARTS];
  struct product part[PARTS];
  struct page_model model; /* of the first run */
  struct flow flow;
  bool has_flow;
  struct plane plane;
  bool has_plane;
  bool blocked; /* a run has k = 0 */
  bool lean;    /* leaves the still pictures to the charts, to stay small */
  json_t *data; /* {"darcy": .., "pdf": .., ...} as embedded */
  FILE *out;
};

extern const char *const page_part_names[PARTS];

/* Runs the analyses that the runs support: page_parts.c. */
enum status page_analyse(struct page *page);

/* Figures: page_figures.c. A section each, none where the page has no such part. */
bool page_is_worth_a_screen(const struct page *page, enum part part);
void page_figure(struct page *page, enum part part, const char *title, const char *caption);
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
