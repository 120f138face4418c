/* Maps of a plane through the middle of a body: velocity, pressure and distance to the grains at
 * the lattice points in it. */
#include <math.h>
#include <string.h>

#include "analyze/report/page_pictures.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/page_encode.h"
#include "common/statistics.h"

#define PLANE_SIDE 256 /* largest number of points per side, so that a page stays small */

/* Colours end at this quantile, so that a few large values do not darken the rest. */
static const double colour_top = 0.98;

/* A point stands for `every` by `every` sites; lengths in its spacings. */
struct plane {
  int axis, across, up; /* normal; horizontal; vertical, along the force */
  size_t size[2], every, layer;
  double spacing[2], low[2], at; /* m; corner; position of the plane along its normal */
  float *distance;               /* [size] in spacings, positive in pores */
  float *velocity;               /* [size][2] m/s in the plane */
  float *speed;                  /* [size] m/s */
  /* [size] Pa relative to its mean, NAN in grains; NULL: not stored. */
  float *pressure;
  /* [size] 1 in soil with pores below the site size, else 0; NULL without such soil. */
  float *soil;
  double speed_high, pressure_high; /* 98th percentiles in the pores, where the colour scales end */
};

static size_t points_of(const struct plane *plane) {
  return plane->size[0] * plane->size[1];
}

static double clamped(double v, size_t size) {
  return fmin(fmax(v, 0.0), (double)size - 1.0);
}

/* Trilinear value of a field of the model at a position (m, from the model's corner); periodic. */
static double model_value(const struct voxel_model *model, const float *field, const double at[3]) {
  size_t low[3], high[3];
  double part[3], value = 0.0;
  for (int d = 0; d < 3; d++) {
    const double n = (double)model->size[d];
    double x = at[d] / model->spacing[d] - 0.5;
    x -= n * floor(x / n);
    low[d] = (size_t)x < model->size[d] ? (size_t)x : model->size[d] - 1;
    high[d] = (low[d] + 1) % model->size[d];
    part[d] = x - (double)low[d];
  }
  for (int corner = 0; corner < 8; corner++) {
    size_t p[3];
    double weight = 1.0;
    for (int d = 0; d < 3; d++) {
      p[d] = (corner >> d & 1) != 0 ? high[d] : low[d];
      weight *= (corner >> d & 1) != 0 ? part[d] : 1.0 - part[d];
    }
    value += weight * (double)field[(p[2] * model->size[1] + p[1]) * model->size[0] + p[0]];
  }
  return value;
}

bool picture_walls(const struct voxel_model *model, const int axes[3], const double low[3],
                   const double step[2], const size_t size[2], float *distance) {
  const bool walls = model->wall_distance != NULL;
  const float *field = walls ? model->wall_distance : model->grain_fraction;
  for (size_t p = 0; field != NULL && p < size[0] * size[1]; p++) {
    const size_t i = p % size[0], j = p / size[0];
    double at[3];
    at[axes[0]] = low[0] + ((double)i + 0.5) * step[0];
    at[axes[1]] = low[1] + ((double)j + 0.5) * step[1];
    at[axes[2]] = low[2];
    const double value = model_value(model, field, at);
    distance[p] = (float)(walls ? value / step[0] : 4.0 * (0.5 - value));
  }
  return field != NULL;
}

/* Approximate distances from the lattice of the run: half a spacing on both sides of each face,
 * smoothed. */
static void approximate_distances(const struct run *run, struct plane *plane) {
  const size_t stride[3] = {1, run->size[0], run->size[0] * run->size[1]};
  for (size_t j = 0; j < plane->size[1]; j++)
    for (size_t i = 0; i < plane->size[0]; i++) {
      double grains = 0.0, count = 0.0;
      for (int k = 0; k < 9; k++) {
        const int beside = k % 3 - 1, above = k / 3 - 1;
        const size_t x = (size_t)clamped((double)i + beside, plane->size[0]) * plane->every;
        const size_t y = (size_t)clamped((double)j + above, plane->size[1]) * plane->every;
        const double weight = k == 4 ? 4.0 : k % 2 != 0 ? 2.0 : 1.0;
        const size_t site =
            plane->layer * stride[plane->axis] + x * stride[plane->across] + y * stride[plane->up];
        if (run->solid != NULL && run->solid[site] != 0) grains += weight;
        count += weight;
      }
      plane->distance[j * plane->size[0] + i] = (float)(0.5 - grains / count);
    }
}

/* Averages the particles of the layer at each point. */
static void fill(const struct run *run, const struct particles *particles, struct plane *plane,
                 float *count) {
  for (size_t i = 0; i < particles->count; i++) {
    const double *x = &particles->points[3 * i], *v = &particles->velocity[3 * i];
    if (fabs(x[plane->axis] - plane->at) > 0.5 * run->spacing[plane->axis]) continue;
    const double a = (x[plane->across] - plane->low[0]) / plane->spacing[0];
    const double b = (x[plane->up] - plane->low[1]) / plane->spacing[1];
    const size_t p = (size_t)clamped(floor(b), plane->size[1]) * plane->size[0] +
                     (size_t)clamped(floor(a), plane->size[0]);
    count[p] += 1.0f;
    plane->velocity[2 * p] += (float)v[plane->across];
    plane->velocity[2 * p + 1] += (float)v[plane->up];
    plane->speed[p] += (float)sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    /* All particles of a plane have the same fields. */
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference)
    if (plane->pressure != NULL) plane->pressure[p] += (float)particles->pressure[i];
    // NOLINTNEXTLINE(clang-analyzer-core.NullDereference)
    if (plane->soil != NULL && particles->micro_porosity[i] > 0.0) plane->soil[p] = 1.0f;
  }
  double mean = 0.0, filled = 0.0;
  for (size_t p = 0; p < points_of(plane); p++) {
    if (!(count[p] > 0)) continue;
    plane->velocity[2 * p] /= count[p];
    plane->velocity[2 * p + 1] /= count[p];
    plane->speed[p] /= count[p];
    if (plane->pressure == NULL) continue;
    plane->pressure[p] /= count[p];
    mean += (double)plane->pressure[p];
    filled += 1.0;
  }
  for (size_t p = 0; plane->pressure != NULL && filled > 0 && p < points_of(plane); p++)
    plane->pressure[p] = count[p] > 0 ? plane->pressure[p] - (float)(mean / filled) : NAN;
}

static enum status find_ranges(struct plane *plane, const float *count) {
  enum status status = STATUS_OK;
  double *values = NULL;
  size_t n = 0;
  TRY(memory_allocate(&values, points_of(plane), sizeof *values, "a plane"));
  for (size_t p = 0; p < points_of(plane); p++)
    if (count[p] > 0) values[n++] = (double)plane->speed[p];
  TRY(quantile_find(values, n, colour_top, &plane->speed_high));
  n = 0;
  for (size_t p = 0; plane->pressure != NULL && p < points_of(plane); p++)
    if (count[p] > 0) values[n++] = fabs((double)plane->pressure[p]);
  TRY(quantile_find(values, n, colour_top, &plane->pressure_high));
cleanup:
  memory_free(&values);
  return status;
}

static double extent_of(const struct run *run, int axis) {
  return (double)run->size[axis] * run->spacing[axis];
}

static void choose_plane(const struct run *run, struct plane *plane) {
  plane->up = 2;
  for (int d = 0; d < 3; d++)
    if (fabs(run->direction[d]) > fabs(run->direction[plane->up])) plane->up = d;
  plane->axis = plane->up == 0 ? 1 : 0;
  plane->across = 3 - plane->up - plane->axis;
  if (extent_of(run, plane->across) < 0.5 * extent_of(run, plane->axis)) { /* a thin body */
    plane->axis = plane->across;
    plane->across = 3 - plane->up - plane->axis;
  }
  const int sides[2] = {plane->across, plane->up};
  const size_t nx = run->size[sides[0]], ny = run->size[sides[1]];
  plane->every = ((nx > ny ? nx : ny) + PLANE_SIDE - 1) / PLANE_SIDE;
  for (int i = 0; i < 2; i++) {
    const int d = sides[i];
    plane->size[i] = (run->size[d] + plane->every - 1) / plane->every;
    plane->spacing[i] = run->spacing[d] * (double)plane->every;
    plane->low[i] = run->origin[d] - 0.5 * run->spacing[d];
  }
  plane->layer = run->size[plane->axis] / 2;
  plane->at = run->origin[plane->axis] + (double)plane->layer * run->spacing[plane->axis];
}

/* Two components as signed square roots of their share of the highest, so that slow water keeps
 * its direction: bytes around 127. */
static json_t *encode_directions(const struct plane *plane) {
  const size_t n = 2 * points_of(plane);
  float *roots = NULL;
  if (memory_allocate(&roots, n, sizeof *roots, "a plane") != STATUS_OK) {
    error_clear();
    return json_null();
  }
  for (size_t i = 0; i < n; i++) {
    const float share = plane->velocity[i] / (float)plane->speed_high;
    roots[i] = copysignf(sqrtf(fminf(fabsf(share), 1.0f)), share);
  }
  json_t *field = encode_field(roots, n, -1.0, 1.0);
  memory_free(&roots);
  return field;
}

static json_t *encode_plane(const struct plane *plane) {
  const size_t n = points_of(plane);
  json_t *picture = json_pack(
      "{s:s#,s:s#,s:s#,s:o,s:[I,I],s:o,s:o,s:o,s:o}", "normal", &"xyz"[plane->axis], 1, "across",
      &"xyz"[plane->across], 1, "up", &"xyz"[plane->up], 1, "at_m", json_number(plane->at), "size",
      (json_int_t)plane->size[0], (json_int_t)plane->size[1], "spacing_m",
      json_numbers(plane->spacing, 2), "distance", encode_field(plane->distance, n, -2.0, 2.0),
      "speed", encode_field(plane->speed, n, 0.0, plane->speed_high), "direction",
      encode_directions(plane));
  if (plane->pressure != NULL && plane->pressure_high > 0.0)
    json_object_set_new(
        picture, "pressure",
        encode_field(plane->pressure, n, -plane->pressure_high, plane->pressure_high));
  if (plane->soil != NULL)
    json_object_set_new(picture, "soil", encode_field(plane->soil, n, 0.0, 1.0));
  return picture;
}

enum status picture_plane(const struct run *run, const struct particles *particles,
                          const struct voxel_model *model, json_t *pictures) {
  enum status status = STATUS_OK;
  struct plane whole = {0}, *plane = &whole;
  float *count = NULL;
  choose_plane(run, plane);
  const size_t n = points_of(plane);
  TRY(memory_allocate(&plane->distance, n, sizeof *plane->distance, "a plane"));
  TRY(memory_allocate(&plane->velocity, 2 * n, sizeof *plane->velocity, "a plane"));
  TRY(memory_allocate(&plane->speed, n, sizeof *plane->speed, "a plane"));
  TRY(memory_allocate(&count, n, sizeof *count, "a plane"));
  if (particles->pressure != NULL)
    TRY(memory_allocate(&plane->pressure, n, sizeof *plane->pressure, "a plane"));
  if (particles->micro_porosity != NULL)
    TRY(memory_allocate(&plane->soil, n, sizeof *plane->soil, "a plane"));
  const int axes[3] = {plane->across, plane->up, plane->axis};
  const double low[3] = {plane->low[0], plane->low[1], plane->at};
  if (!picture_walls(model, axes, low, plane->spacing, plane->size, plane->distance))
    approximate_distances(run, plane);
  fill(run, particles, plane, count);
  TRY(find_ranges(plane, count));
  /* Under a thousandth of what drives the flow it is rounding, and not shown. */
  const double drives = run->density * run_driving(run) * extent_of(run, plane->up);
  if (plane->pressure_high < 1e-3 * drives) plane->pressure_high = 0.0;
  if (plane->speed_high > 0.0) json_object_set_new(pictures, "plane", encode_plane(plane));
cleanup:
  memory_free(&count);
  memory_free(&plane->distance);
  memory_free(&plane->velocity);
  memory_free(&plane->speed);
  memory_free(&plane->pressure);
  memory_free(&plane->soil);
  return status;
}
