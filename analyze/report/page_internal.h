/* The page while it is written: the results of the analyses and the output stream. */
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

/* The result of an analysis on the page; in the order of `analyses`. */
struct part {
  bool there;
  enum showing showing;
  struct product product;
};

struct page {
  struct subject subject;
  const char *command_line;
  struct part parts[ANALYSES];
  struct page_model model;   /* of the first run */
  struct voxel_model voxels; /* contents of that file; without arrays if it could not be read */
  struct flow flow;
  bool has_flow;
  struct plane plane;
  bool lean;    /* omits the static pictures that charts replace, to stay small */
  json_t *data; /* {"darcy": .., "pdf": .., ...} as embedded */
  FILE *out;
};

/* Copies the runs into `ordered` (n), in the order of the page: those with a permeability first.
 * The copies own nothing. Also sets what is known of them in `subject`: page_parts.c. */
enum status page_order(const struct run *runs, size_t n, struct run *ordered,
                       struct subject *subject);
/* Runs the analyses that apply to the runs: page_parts.c. */
enum status page_analyse(struct page *page);
/* The JSON of an analysis, or NULL if the page does not have it. */
const json_t *page_found(const struct page *page, const struct analysis *analysis);

/* Figures, one section each: page_figures.c. Of the analyses, open sections come before collapsed
 * ones. */
void page_analyses(struct page *page);
enum status page_calibration(FILE *out, const json_t *calibration, const struct page_model *model);
enum status page_levels(struct page *page);
enum status page_flow_section(struct page *page);
/* The plot of `body` (gnuplot) as a static picture of that size in points. */
void page_still(FILE *out, const char *name, const char *body, int width, int height,
                const char *title);

/* Flow through soil with pores below the site size, in the first run that has any: page_soil.c. */
bool page_has_soil(const struct page *page);
enum status page_soil(struct page *page);

#endif
