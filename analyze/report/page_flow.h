/* Grains and flow of one run for the three-dimensional view: a coarsened grain field and
 * streamlines, and a still picture of both for where WebGL is missing. */
#ifndef TOSUI_ANALYZE_REPORT_PAGE_FLOW_H
#define TOSUI_ANALYZE_REPORT_PAGE_FLOW_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "analyze/run_file.h"

#define FLOW_SIDE 128             /* most cells along an axis of the coarsened fields */
#define FLOW_CELLS (64 * 64 * 64) /* and in all */

struct flow {
  size_t size[3];    /* cells of the coarse grid, x y z */
  double cell[3];    /* m */
  float *solid;      /* [z][y][x] grain fraction, 0..1 */
  float *velocity;   /* [z][y][x][3] m/s, mean of the particles, 0 in grains */
  double speed_high; /* m/s, 99th percentile; colours end there */
  float *paths; /* [z][y][x] share of the cell's water among that which carries half of the flow;
                 * NULL until paths_find */
  double paths_share; /* of the pores' water, that carries half of the flow */
  size_t line_count, point_count;
  size_t *line_start; /* [line_count + 1] into points */
  float *points;      /* [point_count][4]: x y z in cells, speed / speed_high */
};

/* From /run/solid and the particles of the last snapshot. Free with flow_free. */
enum status flow_build(const struct run *run, const struct particles *particles, struct flow *flow);
void flow_free(struct flow *flow);

/* JSON for page.js: sizes, grains as base64, four bits a cell (the first in the low ones), points
 * as base64 u16. */
void flow_write_json(const struct flow *flow, const char *label, FILE *stream);

/* The fastest water along the force that together carries half of the flow. */
enum status paths_find(const struct run *run, const struct particles *particles, struct flow *flow);
/* <img>: that water as a solid body in a glassy box of grains. */
enum status paths_write(const struct flow *flow, FILE *stream);

/* The cell of a place, periodic. */
size_t flow_cell(const struct run *run, const struct flow *flow, const double at[3]);

/* An orthographic view of the box on a square of `side` pixels; a pixel (u, v) from its middle. */
struct camera {
  double right[3], up[3], forward[3], middle[3], scale; /* cells a pixel */
};
void flow_look(const struct flow *flow, size_t side, struct camera *camera);

/* <img>: orthographic view with a corner cut away, grains shaded, streamlines by speed. */
enum status flow_write_still(const struct flow *flow, FILE *stream);

#endif
