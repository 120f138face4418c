/* Grains and flow in three dimensions: a coarsened grain field, streamlines, and the pores that
 * carry half of the flow. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analyze/report/page_cells.h"
#include "analyze/report/page_pictures.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/page_encode.h"

/* Largest number of cells along an axis, and in total. */
enum { FLOW_SIDE = 128, FLOW_CELLS = 64 * 64 * 64 };
/* Streamlines, the points of each, and the least for one that is shown. */
enum { LINES = 220, LINE_POINTS = 240, LINE_LEAST = 12 };
static const double step = 0.5; /* of a streamline, in cells */

struct flow {
  size_t size[3], cells; /* of a coarse grid, in the order x, y, z */
  double cell[3];        /* m */
  float *solid;          /* [z][y][x] grain fraction, 0..1 */
  float *velocity;       /* [z][y][x][3] m/s, mean of the particles, 0 in grains */
  double speed_high;     /* m/s, where the colour scale ends */
};

/* Chooses cells that are nearly cubic: pictures are drawn in cells and show the body in its
 * proportions only then. */
static void choose_cells(const struct run *run, struct flow *flow) {
  double edge = 0.0;
  for (int d = 0; d < 3; d++)
    edge = fmax(edge, run->spacing[d] * fmax(1.0, (double)run->size[d] / FLOW_SIDE));
  do {
    flow->cells = 1;
    for (int d = 0; d < 3; d++) {
      const double extent = run->spacing[d] * (double)run->size[d];
      flow->size[d] = (size_t)fmin(fmax(rint(extent / edge), 1.0), (double)run->size[d]);
      flow->cell[d] = extent / (double)flow->size[d];
      flow->cells *= flow->size[d];
    }
    edge *= 1.02;
  } while (flow->cells > FLOW_CELLS);
}

static size_t index_of(const struct flow *flow, const size_t at[3]) {
  return (at[2] * flow->size[1] + at[1]) * flow->size[0] + at[0];
}

static enum status fill_solid(const struct run *run, struct flow *flow) {
  enum status status = STATUS_OK;
  float *count = NULL;
  TRY(memory_allocate(&flow->solid, flow->cells, sizeof *flow->solid, "grains"));
  TRY(memory_allocate(&count, flow->cells, sizeof *count, "grains"));
  if (run->solid == NULL) goto cleanup;
  for (size_t site = 0; site < run->size[0] * run->size[1] * run->size[2]; site++) {
    const size_t fine[3] = {site % run->size[0], site / run->size[0] % run->size[1],
                            site / run->size[0] / run->size[1]};
    size_t at[3];
    for (int d = 0; d < 3; d++) at[d] = fine[d] * flow->size[d] / run->size[d];
    count[index_of(flow, at)] += 1.0f;
    if (run->solid[site] != 0) flow->solid[index_of(flow, at)] += 1.0f;
  }
  for (size_t c = 0; c < flow->cells; c++) flow->solid[c] /= count[c];
cleanup:
  memory_free(&count);
  return status;
}

/* Cells of the particles; periodic images are taken into the box. */
static enum status find_cells(const struct run *run, const struct flow *flow,
                              const struct particles *particles, size_t **cell) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(cell, particles->count, sizeof **cell, "cells"));
  for (size_t i = 0; i < particles->count; i++) {
    size_t at[3];
    for (int d = 0; d < 3; d++) {
      const double low = run->origin[d] - 0.5 * run->spacing[d], n = (double)flow->size[d];
      const double c = floor((particles->points[3 * i + (size_t)d] - low) / flow->cell[d]);
      at[d] = (size_t)fmin(fmax(c - n * floor(c / n), 0.0), n - 1.0);
    }
    (*cell)[i] = index_of(flow, at);
  }
cleanup:
  return status;
}

static enum status fill_velocity(const struct particles *particles, const size_t *cell,
                                 struct flow *flow) {
  enum status status = STATUS_OK;
  float *speed = NULL;
  TRY(memory_allocate(&speed, flow->cells, sizeof *speed, "speeds"));
  TRY(cells_mean(cell, particles->count, particles->velocity, 3, flow->cells, &flow->velocity));
  for (size_t c = 0; c < flow->cells; c++) {
    float *v = &flow->velocity[3 * c];
    speed[c] = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (isnan(speed[c])) memset(v, 0, 3 * sizeof *v);
  }
  TRY(cells_high(speed, flow->cells, &flow->speed_high));
cleanup:
  memory_free(&speed);
  return status;
}

/* Trilinear velocity at a position in cells, and its magnitude; 0 outside of the box. */
static double velocity_at(const struct flow *flow, const double at[3], double v[3]) {
  size_t low[3];
  double part[3];
  for (int d = 0; d < 3; d++) {
    v[d] = 0.0;
    if (!(at[d] >= 0.0) || at[d] > (double)flow->size[d]) return 0.0;
    const double c = fmin(fmax(at[d] - 0.5, 0.0), (double)flow->size[d] - 1.0);
    low[d] = (size_t)c;
    part[d] = c - (double)low[d];
  }
  for (int corner = 0; corner < 8; corner++) {
    size_t p[3];
    double weight = 1.0;
    for (int d = 0; d < 3; d++) {
      const bool up = (corner >> d & 1) != 0;
      p[d] = up && low[d] + 1 < flow->size[d] ? low[d] + 1 : low[d];
      weight *= up ? part[d] : 1.0 - part[d];
    }
    for (size_t d = 0; d < 3; d++)
      v[d] += weight * (double)flow->velocity[3 * index_of(flow, p) + d];
  }
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Moves `at` by one step along the flow (sign 1) or against it, by the midpoint method. Returns the
 * speed there, m/s; 0: the line ends, in a grain, at the boundary of the box or at rest. */
static double follow(const struct flow *flow, double sign, double at[3]) {
  double v[3], middle[3];
  size_t cell[3];
  const double start = velocity_at(flow, at, v);
  if (start < 1e-3 * flow->speed_high) return 0.0;
  for (int d = 0; d < 3; d++) {
    cell[d] = (size_t)fmin(at[d], (double)flow->size[d] - 1.0);
    middle[d] = at[d] + 0.5 * step * sign * v[d] / start * flow->cell[0] / flow->cell[d];
  }
  if (flow->solid[index_of(flow, cell)] > 0.5f) return 0.0;
  const double speed = velocity_at(flow, middle, v);
  if (!(speed > 0.0)) return 0.0;
  for (int d = 0; d < 3; d++) at[d] += step * sign * v[d] / speed * flow->cell[0] / flow->cell[d];
  return start;
}

static double random_unit(uint64_t *state) { /* generator MMIX of Knuth, reproducible */
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 0x1p53;
}

/* Adds streamlines through places evenly distributed over the pores. Positions in 1/500 cell
 * (enough for FLOW_SIDE cells) and speeds over the highest times 65535. */
static enum status add_lines(const struct flow *flow, json_t *picture) {
  enum status status = STATUS_OK;
  uint64_t state = 2006;
  size_t points = 0;
  uint16_t(*words)[4] = NULL;
  json_t *lines = json_array();
  json_object_set_new(picture, "lines", lines);
  TRY(memory_allocate(&words, (size_t)LINES * LINE_POINTS, sizeof *words, "streamlines"));
  const int tries = flow->speed_high > 0.0 ? 40 * LINES : 0;
  for (int i = 0; i < tries && json_array_size(lines) < LINES; i++) {
    double at[3], last[3], from[3];
    size_t n = 0;
    for (int d = 0; d < 3; d++) from[d] = at[d] = random_unit(&state) * (double)flow->size[d];
    for (int back = 0; back < LINE_POINTS / 2; back++) { /* to where the line begins */
      memcpy(last, at, sizeof last);
      if (!(follow(flow, -1.0, at) > 0.0)) break;
      memcpy(from, last, sizeof from);
    }
    for (double place[3], speed; n < LINE_POINTS; n++) {
      memcpy(place, from, sizeof place);
      if (!((speed = follow(flow, 1.0, from)) > 0.0)) break;
      for (int d = 0; d < 3; d++) words[points + n][d] = (uint16_t)lrint(500.0 * place[d]);
      words[points + n][3] = (uint16_t)lrint(65535.0 * fmin(speed / flow->speed_high, 1.0));
    }
    if (n < LINE_LEAST) continue;
    json_array_append_new(lines, json_integer((json_int_t)n));
    points += n;
  }
  json_object_set_new(picture, "points", encode_bytes(words, points * sizeof *words));
cleanup:
  memory_free(&words);
  return status;
}

static int falling(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? 1 : x > y ? -1 : 0;
}

/* Adds "paths": the fastest water along the force that together carries half of the flow. */
static enum status add_paths(const struct run *run, const struct particles *particles,
                             const size_t *cell, const struct flow *flow, json_t *picture) {
  enum status status = STATUS_OK;
  const size_t n = particles->count;
  double *speeds = NULL, *sorted = NULL, total = 0.0, carried = 0.0;
  float *paths = NULL;
  size_t carriers = 0;
  TRY(memory_allocate(&speeds, n, sizeof *speeds, "speeds"));
  TRY(memory_allocate(&sorted, n, sizeof *sorted, "speeds"));
  for (size_t i = 0; i < n; i++) {
    for (size_t d = 0; d < 3; d++) speeds[i] += particles->velocity[3 * i + d] * run->direction[d];
    total += speeds[i];
  }
  memcpy(sorted, speeds, n * sizeof *sorted);
  qsort(sorted, n, sizeof *sorted, falling);
  while (carriers < n && carried < 0.5 * total) carried += sorted[carriers++];
  const double least = carriers > 0 ? sorted[carriers - 1] : INFINITY;
  for (size_t i = 0; i < n; i++) speeds[i] = speeds[i] >= least ? 1.0 : 0.0;
  TRY(cells_mean(cell, n, speeds, 1, flow->cells, &paths));
  for (size_t c = 0; c < flow->cells; c++)
    paths[c] = isnan(paths[c]) ? 0.0f : paths[c] * (1.0f - flow->solid[c]);
  json_object_set_new(picture, "paths", encode_nibbles(paths, flow->cells));
  json_put_number(picture, "pore_share_of_half_the_flow", (double)carriers / (double)n);
cleanup:
  memory_free(&speeds);
  memory_free(&sorted);
  memory_free(&paths);
  return status;
}

enum status picture_flow(const struct run *run, const struct particles *particles, bool paths,
                         json_t *pictures) {
  enum status status = STATUS_OK;
  struct flow flow = {0};
  size_t *cell = NULL;
  choose_cells(run, &flow);
  TRY(find_cells(run, &flow, particles, &cell));
  TRY(fill_solid(run, &flow));
  TRY(fill_velocity(particles, cell, &flow));
  json_t *picture = json_pack(
      "{s:[I,I,I],s:o,s:o,s:o}", "size", (json_int_t)flow.size[0], (json_int_t)flow.size[1],
      (json_int_t)flow.size[2], "cell_m", json_numbers(flow.cell, 3), "speed_high",
      json_number(flow.speed_high), "grains", encode_nibbles(flow.solid, flow.cells));
  json_object_set_new(pictures, "flow", picture);
  TRY(add_lines(&flow, picture));
  if (paths && flow.speed_high > 0.0) TRY(add_paths(run, particles, cell, &flow, picture));
cleanup:
  memory_free(&cell);
  memory_free(&flow.solid);
  memory_free(&flow.velocity);
  return status;
}
