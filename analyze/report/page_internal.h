/* The page while it is made: the results of the analyses, and the JSON that it shows. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_INTERNAL_H
#define TOSUI_ANALYZE_REPORT_PAGE_INTERNAL_H

#include <jansson.h>

#include "analyze/analysis.h"
#include "analyze/product.h"
#include "analyze/report/page_model.h"
#include "analyze/run_file.h"
#include "common/model_file.h"

/* The result of an analysis on the page; in the order of `analyses`. */
struct part {
  bool there, shown;
  struct product product;
};

struct page {
  struct subject subject;
  const char *command_line;
  struct part parts[ANALYSES];
  struct page_model model;   /* of the first run */
  struct voxel_model voxels; /* contents of that file; without arrays if it could not be read */
  json_t *data;              /* as embedded */
};

/* Copies the runs into `ordered` (n), in the order of the page: those with a permeability first.
 * The copies own nothing. Also sets what is known of them in `subject`: page_parts.c. */
enum status page_order(const struct run *runs, size_t n, struct run *ordered,
                       struct subject *subject);
/* Runs the analyses that apply to the runs; their JSON goes into `data`: page_parts.c. */
enum status page_analyse(struct page *page);
/* The JSON of an analysis, or NULL if the page does not have it. */
const json_t *page_found(const struct page *page, const struct analysis *analysis);

/* Adds "pictures" to `data`: page_pictures.c. Each is an object that page_maps.js or
 * page_solid.js draws, and is
 * absent where there is nothing to show: "slice" the middle slice of the scan with the walls found
 * in it, "plane" maps of the flow, "flow" grains, streamlines and paths in three dimensions,
 * "frames" water and soil at some times. */
enum status page_pictures(struct page *page);

#endif
