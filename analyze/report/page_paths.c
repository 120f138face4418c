/* The pores that carry half of the flow, and their picture. */
#include <math.h>
#include <stdlib.h>

#include "analyze/report/page_flow.h"
#include "analyze/report/page_html.h"
#include "common/memory.h"

#define SIDE 480 /* pixels of the picture */

static double along(const struct run *run, const double v[3]) {
  return v[0] * run->direction[0] + v[1] * run->direction[1] + v[2] * run->direction[2];
}

static int falling(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return x < y ? 1 : x > y ? -1 : 0;
}

enum status paths_find(const struct run *run, const struct particles *particles,
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

/* Trilinear value of a cell field; 0 outside of the box. */
static double value_at(const struct flow *flow, const float *field, const double at[3]) {
  size_t low[3];
  double part[3], value = 0.0;
  for (int d = 0; d < 3; d++) {
    if (!(at[d] > 0.0) || !(at[d] < (double)flow->size[d])) return 0.0;
    const double inside = at[d] > 0.5 ? at[d] - 0.5 : 0.0, last = (double)flow->size[d] - 1.0;
    const double c = inside < last ? inside : last;
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
    value += weight * (double)field[(p[2] * flow->size[1] + p[1]) * flow->size[0] + p[0]];
  }
  return value;
}

/* Brightness of a surface of `field`, with light from the upper left. */
static double lit_at(const struct flow *flow, const float *field, const double at[3]) {
  static const double light[3] = {0.35, 0.55, -0.76};
  double length = 0.0, lit = 0.0, g[3];
  for (int d = 0; d < 3; d++) {
    double a[3] = {at[0], at[1], at[2]}, b[3] = {at[0], at[1], at[2]};
    a[d] -= 1.0;
    b[d] += 1.0;
    g[d] = value_at(flow, field, b) - value_at(flow, field, a);
    length += g[d] * g[d];
  }
  length = sqrt(length);
  for (int d = 0; d < 3; d++) lit += length > 0 ? g[d] / length * light[d] : 0.4 * light[d];
  return 0.4 + 0.6 * fmax(lit, 0.0);
}

/* Traces one ray: the surfaces of grains on its way absorb some light, the paths all that is
 * left. */
static void march(const struct flow *flow, const struct camera *camera, double u, double v,
                  double reach, uint8_t rgb[3]) {
  static const double water[3] = {20, 92, 180}, grain[3] = {150, 138, 116};
  double colour[3] = {255, 255, 255}, left = 1.0, sum[3] = {0};
  bool inside = false;
  for (double t = -reach; t < reach && left > 0.02; t += 0.5) { // NOLINT: halves are exact
    double p[3];
    for (int d = 0; d < 3; d++)
      p[d] = camera->middle[d] + u * camera->right[d] + v * camera->up[d] + t * camera->forward[d];
    if (value_at(flow, flow->paths, p) > 0.35) {
      const double lit = lit_at(flow, flow->paths, p);
      for (int c = 0; c < 3; c++) sum[c] += left * water[c] * lit * 1.2;
      left = 0.0;
      break;
    }
    const bool solid = value_at(flow, flow->solid, p) > 0.5;
    if (solid && !inside) {
      const double lit = lit_at(flow, flow->solid, p), opacity = 0.1;
      for (int c = 0; c < 3; c++) sum[c] += left * opacity * grain[c] * lit;
      left *= 1.0 - opacity;
    }
    inside = solid;
  }
  for (int c = 0; c < 3; c++) rgb[c] = (uint8_t)fmin(fmax(sum[c] + left * colour[c], 0.0), 255.0);
}

enum status paths_write(const struct flow *flow, FILE *stream) {
  enum status status = STATUS_OK;
  uint8_t *pixels = NULL;
  struct camera camera;
  flow_camera(flow, SIDE, &camera);
  TRY(memory_allocate(&pixels, (size_t)3 * SIDE * SIDE, 1, "a picture"));
#pragma omp parallel for schedule(dynamic, 8)
  for (size_t y = 0; y < SIDE; y++)
    for (size_t x = 0; x < SIDE; x++)
      march(flow, &camera, ((double)x + 0.5 - 0.5 * SIDE) * camera.scale,
            (0.5 * SIDE - (double)y - 0.5) * camera.scale, 0.5 * camera.scale * SIDE,
            pixels + 3 * (y * SIDE + x));
  TRY(html_picture(stream, pixels, 3, SIDE, SIDE, NULL,
                   "The pores that carry half of the flow, in the glassy grains"));
cleanup:
  memory_free(&pixels);
  return status;
}
