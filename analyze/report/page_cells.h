/* Pictures as cells: what points lie in them, and the means of their fields. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_CELLS_H
#define TOSUI_ANALYZE_REPORT_PAGE_CELLS_H

#include <stddef.h>

#include "analyze/run_file.h"

/* Cells of a plane through the middle of a run: `every` by `every` sites each. */
struct plane {
  int across, up, normal; /* axes */
  size_t size[2], every;
  double cell[2], low[2], at; /* m: of a cell; corner along across and up; place along normal */
};

/* The plane along two axes, with at most `side` cells along each. */
struct plane plane_along(const struct run *run, int across, int up, size_t side);
/* The site of a run in the plane at the corner of cell (i, j). */
size_t plane_site(const struct run *run, const struct plane *plane, size_t i, size_t j);

#define CELL_NONE SIZE_MAX
/* Cell of each of n points within `reach` (m) of the plane, else CELL_NONE; what drifted out of the
 * domain is in its outermost cells. In new memory. */
enum status plane_cells(const struct plane *plane, const double *points, size_t n, double reach,
                        size_t **cell);

/* Means of a field with so many components over the points in each cell, in new memory; NAN where
 * there are none. */
enum status cells_mean(const size_t *cell, size_t n, const double *values, size_t components,
                       size_t cells, float **means);

/* Where a scale of colours ends, so that a few large values do not darken the rest: the 98th
 * percentile of the magnitudes above 0; 0 without any. */
enum status cells_high(const float *values, size_t n, double *high);

#endif
