/* Grains and flow in three dimensions: a coarsened grain field, streamlines, and the pores that
 * carry half of the flow. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analyze/report/page_pictures.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/page_encode.h"
#include "common/statistics.h"

/* Largest number of cells along an axis of the coarsened fields. */
#define FLOW_SIDE 128
#define FLOW_CELLS (64 * 64 * 64) /* and in total */
#define LINES 220                 /* streamlines to be traced */
#define LINE_POINTS 240           /* largest number of points of a streamline */
static const double step = 0.5;   /* of a streamline, in cells */

struct flow {
  size_t size[3];    /* cells of the coarse grid, in the order x, y, z */
  double cell[3];    /* m */
  float *solid;      /* [z][y][x] grain fraction, 0..1 */
  float *velocity;   /* [z][y][x][3] m/s, mean of the particles, 0 in grains */
  double speed_high; /* m/s, 99th percentile, where the colour scale ends */
  /* [z][y][x] share of the cell's water that belongs to the part carrying half of the flow */
  float *paths;
  double paths_share; /* share of the pore water that carries half of the flow */
  size_t line_count, point_count;
  size_t *line_start; /* [line_count + 1] into points */
  float *points;      /* [point_count][4]: x y z in cells, speed / speed_high */
};

static size_t index_of(const struct flow *flow, size_t x, size_t y, size_t z) {
  return (z * flow->size[1] + y) * flow->size[0] + x;
}

/* Index on the coarse grid for an index or coordinate on the fine grid. */
static size_t coarse(size_t fine, size_t from, size_t to) {
  return fine * to / from;
}

static enum status fill_solid(const struct run *run, struct flow *flow) {
  enum status status = STATUS_OK;
  float *count = NULL;
  size_t cells = flow->size[0] * flow->size[1] * flow->size[2];
  TRY(memory_allocate(&flow->solid, cells, sizeof *flow->solid, "grains"));
  if (run->solid == NULL) return STATUS_OK;
  TRY(memory_allocate(&count, cells, sizeof *count, "grains"));
  for (size_t z = 0, site = 0; z < run->size[2]; z++)
    for (size_t y = 0; y < run->size[1]; y++)
      for (size_t x = 0; x < run->size[0]; x++, site++) {
        size_t c = index_of(flow, coarse(x, run->size[0], flow->size[0]),
                            coarse(y, run->size[1], flow->size[1]),
                            coarse(z, run->size[2], flow->size[2]));
        count[c] += 1.0f;
        flow->solid[c] += run->solid[site] != 0 ? 1.0f : 0.0f;
      }
  for (size_t c = 0; c < cells; c++) flow->solid[c] /= count[c];
cleanup:
  memory_free(&count);
  return status;
}

/* Index of the cell at a position, periodic. */
static size_t flow_cell(const struct run *run, const struct flow *flow, const double place[3]) {
  size_t at[3];
  for (int d = 0; d < 3; d++) {
    double low = run->origin[d] - 0.5 * run->spacing[d];
    double c = floor((place[d] - low) / flow->cell[d]);
    double n = (double)flow->size[d];
    c -= n * floor(c / n); /* wraps periodic images into the box */
    at[d] = (size_t)fmin(fmax(c, 0.0), n - 1.0);
  }
  return index_of(flow, at[0], at[1], at[2]);
}

/* Mean particle velocity of each cell. */
static enum status fill_velocity(const struct run *run, const struct particles *particles,
                                 struct flow *flow) {
  enum status status = STATUS_OK;
  size_t cells = flow->size[0] * flow->size[1] * flow->size[2];
  float *count = NULL;
  TRY(memory_allocate(&flow->velocity, 3 * cells, sizeof *flow->velocity, "velocities"));
  TRY(memory_allocate(&count, cells, sizeof *count, "velocities"));
  for (size_t i = 0; i < particles->count; i++) {
    size_t cell = flow_cell(run, flow, &particles->points[3 * i]);
    count[cell] += 1.0f;
    for (size_t d = 0; d < 3; d++)
      flow->velocity[3 * cell + d] += (float)particles->velocity[3 * i + d];
  }
  for (size_t c = 0; c < cells; c++)
    for (size_t d = 0; d < 3 && count[c] > 0; d++) flow->velocity[3 * c + d] /= count[c];
cleanup:
  memory_free(&count);
  return status;
}

/* Trilinear velocity (cells/s) at a position in cells; false outside of the flow. */
static bool velocity_at(const struct flow *flow, const double at[3], double v[3]) {
  size_t low[3];
  double part[3];
  for (int d = 0; d < 3; d++) {
    if (!(at[d] >= 0.0) || at[d] > (double)flow->size[d]) return false;
    double c = fmin(fmax(at[d] - 0.5, 0.0), (double)flow->size[d] - 1.0);
    low[d] = (size_t)c;
    part[d] = c - (double)low[d];
    v[d] = 0.0;
  }
  for (int corner = 0; corner < 8; corner++) {
    size_t p[3];
    double weight = 1.0;
    for (int d = 0; d < 3; d++) {
      bool up = (corner >> d & 1) != 0;
      p[d] = up && low[d] + 1 < flow->size[d] ? low[d] + 1 : low[d];
      weight *= up ? part[d] : 1.0 - part[d];
    }
    size_t c = index_of(flow, p[0], p[1], p[2]);
    for (size_t d = 0; d < 3; d++)
      v[d] += weight * (double)flow->velocity[3 * c + d] / flow->cell[d];
  }
  return true;
}

/* Traces a streamline by the midpoint method with `step` cells per step in the direction sign * v,
 * into points (4 floats each). Ends in grains, at the boundary of the box and where the flow is at
 * rest. Returns the number of points. */
static size_t trace(const struct flow *flow, const double seed[3], double sign, size_t most,
                    float *points) {
  double at[3] = {seed[0], seed[1], seed[2]};
  size_t n = 0;
  while (n < most) {
    double v[3], middle[3], speed = 0.0, metres = 0.0;
    if (!velocity_at(flow, at, v)) break;
    for (int d = 0; d < 3; d++) {
      speed += v[d] * v[d];
      metres += v[d] * flow->cell[d] * v[d] * flow->cell[d];
    }
    speed = sqrt(speed);
    metres = sqrt(metres);
    size_t cell[3];
    for (int d = 0; d < 3; d++) cell[d] = (size_t)fmin(at[d], (double)flow->size[d] - 1.0);
    if (metres < 1e-3 * flow->speed_high ||
        flow->solid[index_of(flow, cell[0], cell[1], cell[2])] > 0.5f)
      break;
    for (int d = 0; d < 3; d++) {
      points[4 * n + (size_t)d] = (float)at[d];
      middle[d] = at[d] + 0.5 * step * sign * v[d] / speed;
    }
    points[4 * n + 3] = (float)fmin(metres / flow->speed_high, 1.0);
    n++;
    if (!velocity_at(flow, middle, v)) break;
    speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!(speed > 0.0)) break;
    for (int d = 0; d < 3; d++) at[d] += step * sign * v[d] / speed;
  }
  return n;
}

static double random_unit(uint64_t *state) { /* generator MMIX of Knuth, reproducible */
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 0x1p53;
}

/* Starts streamlines evenly distributed over the pores; each is traced in both directions and
 * joined. */
static enum status fill_lines(struct flow *flow) {
  enum status status = STATUS_OK;
  float *backward = NULL;
  uint64_t state = 2006;
  const size_t half = LINE_POINTS / 2;
  TRY(memory_allocate(&flow->line_start, LINES + 1, sizeof *flow->line_start, "streamlines"));
  TRY(memory_allocate(&flow->points, (size_t)LINES * LINE_POINTS, 4 * sizeof *flow->points,
                      "streamlines"));
  TRY(memory_allocate(&backward, half, 4 * sizeof *backward, "streamlines"));
  for (int tries = 0; tries < 40 * LINES && flow->line_count < LINES; tries++) {
    double seed[3];
    for (int d = 0; d < 3; d++) seed[d] = random_unit(&state) * (double)flow->size[d];
    size_t n = trace(flow, seed, -1.0, half, backward);
    float *points = flow->points + 4 * flow->point_count;
    for (size_t i = 0; i < n; i++)
      memcpy(points + 4 * i, backward + 4 * (n - 1 - i), 4 * sizeof *points);
    n += n > 0 ? trace(flow, seed, 1.0, half, points + 4 * (n - 1)) : 0;
    if (n < 12) continue; /* too short to be useful */
    flow->point_count += n - 1;
    flow->line_start[++flow->line_count] = flow->point_count;
  }
cleanup:
  memory_free(&backward);
  return status;
}

/* Chooses cells that are nearly cubic: pictures are drawn in cells and show the body in its
 * proportions only then. */
static void choose_cells(const struct run *run, struct flow *flow) {
  double edge = 0.0;
  size_t cells;
  for (int d = 0; d < 3; d++)
    if (run->size[d] > 1)
      edge = fmax(edge, run->spacing[d] * fmax(1.0, (double)run->size[d] / FLOW_SIDE));
  do {
    cells = 1;
    for (int d = 0; d < 3; d++) {
      const double extent = run->spacing[d] * (double)run->size[d];
      const size_t n = run->size[d] > 1 ? (size_t)lrint(extent / edge) : 1;
      flow->size[d] = n < 1 ? 1 : n > run->size[d] ? run->size[d] : n;
      flow->cell[d] = extent / (double)flow->size[d];
      cells *= flow->size[d];
    }
    edge *= 1.02;
  } while (cells > FLOW_CELLS);
}

static double along(const struct run *run, const double v[3]) {
  return v[0] * run->direction[0] + v[1] * run->direction[1] + v[2] * run->direction[2];
}

static int falling(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? 1 : x > y ? -1 : 0;
}

/* Finds the fastest water along the force that together carries half of the flow. */
static enum status find_paths(const struct run *run, const struct particles *particles,
                              struct flow *flow) {
  enum status status = STATUS_OK;
  const size_t cells = flow->size[0] * flow->size[1] * flow->size[2];
  double *speeds = NULL, total = 0.0, carried = 0.0;
  float *count = NULL;
  size_t carriers = 0;
  TRY(memory_allocate(&flow->paths, cells, sizeof *flow->paths, "the flow's carriers"));
  TRY(memory_allocate(&count, cells, sizeof *count, "the flow's carriers"));
  TRY(memory_allocate(&speeds, particles->count, sizeof *speeds, "speeds"));
  for (size_t i = 0; i < particles->count; i++)
    total += speeds[i] = along(run, &particles->velocity[3 * i]);
  qsort(speeds, particles->count, sizeof *speeds, falling);
  while (carriers < particles->count && carried < 0.5 * total) carried += speeds[carriers++];
  const double least = carriers > 0 ? speeds[carriers - 1] : INFINITY;
  flow->paths_share = (double)carriers / (double)particles->count;
  for (size_t i = 0; i < particles->count; i++) {
    const size_t cell = flow_cell(run, flow, &particles->points[3 * i]);
    count[cell] += 1.0f;
    if (along(run, &particles->velocity[3 * i]) >= least) flow->paths[cell] += 1.0f;
  }
  for (size_t c = 0; c < cells; c++)
    if (count[c] > 0) flow->paths[c] *= (1.0f - flow->solid[c]) / count[c];
cleanup:
  memory_free(&count);
  memory_free(&speeds);
  return status;
}

/* Positions in 1/500 cell (enough for FLOW_SIDE cells) and speeds over the highest times 65535, as
 * unsigned 16-bit integers. */
static enum status encode_lines(const struct flow *flow, json_t *picture) {
  enum status status = STATUS_OK;
  json_t *lines = json_array();
  uint16_t *words = NULL;
  TRY(memory_allocate(&words, 4 * flow->point_count + 1, sizeof *words, "streamlines"));
  for (size_t i = 0; i < 4 * flow->point_count; i++)
    words[i] = (uint16_t)lrintf(flow->points[i] * (i % 4 == 3 ? 65535.0f : 500.0f));
  for (size_t i = 0; i < flow->line_count; i++)
    json_array_append_new(
        lines, json_integer((json_int_t)(flow->line_start[i + 1] - flow->line_start[i])));
  json_object_set(picture, "lines", lines);
  json_object_set_new(picture, "points", encode_bytes(words, 8 * flow->point_count));
cleanup:
  json_decref(lines);
  memory_free(&words);
  return status;
}

static void flow_free(struct flow *flow) {
  memory_free(&flow->solid);
  memory_free(&flow->velocity);
  memory_free(&flow->paths);
  memory_free(&flow->line_start);
  memory_free(&flow->points);
}

enum status picture_flow(const struct run *run, const struct particles *particles, bool paths,
                         json_t *pictures) {
  enum status status = STATUS_OK;
  double *speeds = NULL;
  struct flow flow = {0};
  choose_cells(run, &flow);
  TRY(fill_solid(run, &flow));
  TRY(fill_velocity(run, particles, &flow));
  TRY(memory_allocate(&speeds, particles->count, sizeof *speeds, "speeds"));
  for (size_t i = 0; i < particles->count; i++) {
    const double *v = &particles->velocity[3 * i];
    speeds[i] = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  }
  TRY(quantile_find(speeds, particles->count, 0.99, &flow.speed_high));
  if (flow.speed_high > 0.0) TRY(fill_lines(&flow));
  const size_t cells = flow.size[0] * flow.size[1] * flow.size[2];
  json_t *picture = json_pack(
      "{s:[I,I,I],s:o,s:o,s:o}", "size", (json_int_t)flow.size[0], (json_int_t)flow.size[1],
      (json_int_t)flow.size[2], "cell_m", json_numbers(flow.cell, 3), "speed_high",
      json_number(flow.speed_high), "grains", encode_nibbles(flow.solid, cells));
  json_object_set_new(pictures, "flow", picture);
  TRY(encode_lines(&flow, picture));
  if (paths && flow.speed_high > 0.0) {
    TRY(find_paths(run, particles, &flow));
    json_object_set_new(picture, "paths", encode_nibbles(flow.paths, cells));
    json_put_number(picture, "pore_share_of_half_the_flow", flow.paths_share);
  }
cleanup:
  memory_free(&speeds);
  flow_free(&flow);
  return status;
}
