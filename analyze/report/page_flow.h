/* Grains and flow of a run for the three-dimensional view: a coarsened grain field, streamlines,
 * and a static picture of both as a substitute for WebGL. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_FLOW_H
#define TOSUI_ANALYZE_REPORT_PAGE_FLOW_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* Largest number of cells along an axis of the coarsened fields. */
#define FLOW_SIDE 128
#define FLOW_CELLS (64 * 64 * 64) /* and in total */

struct flow {
  size_t size[3];    /* cells of the coarse grid, in the order x, y, z */
  double cell[3];    /* m */
  float *solid;      /* [z][y][x] grain fraction, 0..1 */
  float *velocity;   /* [z][y][x][3] m/s, mean of the particles, 0 in grains */
  double speed_high; /* m/s, 99th percentile, where the colour scale ends */
  /* [z][y][x] share of the cell's water that belongs to the part carrying half of the flow; NULL
   * before paths_find. */
  float *paths;
  double paths_share; /* share of the pore water that carries half of the flow */
  size_t line_count, point_count;
  size_t *line_start; /* [line_count + 1] into points */
  float *points;      /* [point_count][4]: x y z in cells, speed / speed_high */
};

/* From /run/solid and the particles of the last snapshot. Free with flow_free. */
enum status flow_build(const struct run *run, const struct particles *particles, struct flow *flow);
void flow_free(struct flow *flow);

/* Writes JSON for page.js: sizes; grains as base64 with four bits per cell (the first in the low
 * bits); points as base64 of 16-bit integers. */
void flow_write_json(const struct flow *flow, const char *label, FILE *stream);

/* Finds the fastest water along the force that together carries half of the flow. */
enum status paths_find(const struct run *run, const struct particles *particles, struct flow *flow);
/* Writes an <img> of that water as a solid body, with transparent grains. */
enum status paths_write(const struct flow *flow, FILE *stream);

/* Index of the cell at a position, periodic. */
size_t flow_cell(const struct run *run, const struct flow *flow, const double at[3]);

/* Orthographic view of the box on a square of `side` pixels; (u, v) is measured from the middle. */
struct camera {
  double right[3], up[3], forward[3], middle[3], scale; /* cells per pixel */
};
void flow_camera(const struct flow *flow, size_t side, struct camera *camera);

/* Writes an <img>: orthographic view with a corner cut away, grains shaded, streamlines coloured by
 * speed. */
enum status flow_write_still(const struct flow *flow, FILE *stream);

#endif
