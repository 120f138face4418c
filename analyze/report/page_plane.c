/* Maps of a plane through the middle of a body: velocity, pressure and distance to the grains at
 * the lattice points in it. */
#include <math.h>

#include "analyze/report/page_cells.h"
#include "analyze/report/page_pictures.h"
#include "common/json_number.h"
#include "common/memory.h"
#include "common/page_encode.h"

#define PLANE_SIDE 256 /* largest number of points per side, so that a page stays small */

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

/* Half a spacing on both sides of the faces of the lattice's own walls. */
static void lattice_distances(const struct run *run, const struct plane *plane, float *distance) {
  for (size_t p = 0; p < plane->size[0] * plane->size[1]; p++) {
    const size_t site = plane_site(run, plane, p % plane->size[0], p / plane->size[0]);
    distance[p] = run->solid != NULL && run->solid[site] != 0 ? -0.5f : 0.5f;
  }
}

static double extent_of(const struct run *run, int axis) {
  return (double)run->size[axis] * run->spacing[axis];
}

/* Upwards is along the force; of the other axes the longer is across. */
static struct plane choose_plane(const struct run *run) {
  int up = 2;
  for (int d = 0; d < 3; d++)
    if (fabs(run->direction[d]) > fabs(run->direction[up])) up = d;
  int normal = up == 0 ? 1 : 0, across = 3 - up - normal;
  if (extent_of(run, across) < 0.5 * extent_of(run, normal)) across = normal; /* a thin body */
  return plane_along(run, across, up, PLANE_SIDE);
}

/* Speeds, and the directions of the velocities within the plane, 0 at rest. */
static void split_velocity(const struct plane *plane, const float *velocity, float *speed,
                           float *direction) {
  for (size_t p = 0; p < plane->size[0] * plane->size[1]; p++) {
    const float *v = &velocity[3 * p], a = v[plane->across], b = v[plane->up];
    const float within = sqrtf(a * a + b * b);
    const float all = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    speed[p] = all > 0.0f ? all : 0.0f; /* not NAN: near walls, maps interpolate */
    direction[2 * p] = within > 0.0f ? a / within : 0.0f;
    direction[2 * p + 1] = within > 0.0f ? b / within : 0.0f;
  }
}

/* "pressure" about its mean, if it is more than rounding: a thousandth of what drives the flow. */
static enum status add_pressure(const struct run *run, const struct plane *plane, float *pressure,
                                json_t *picture) {
  enum status status = STATUS_OK;
  const size_t n = plane->size[0] * plane->size[1];
  double sum = 0.0, count = 0.0, high;
  for (size_t p = 0; p < n; p++) {
    if (!isfinite(pressure[p])) continue;
    sum += (double)pressure[p];
    count += 1.0;
  }
  for (size_t p = 0; p < n; p++) pressure[p] -= (float)(sum / count);
  TRY(cells_high(pressure, n, &high));
  if (high > 0.0 && high >= 1e-3 * run->density * run_driving(run) * extent_of(run, plane->up))
    json_object_set_new(picture, "pressure", encode_field(pressure, n, -high, high));
cleanup:
  return status;
}

static json_t *plane_json(const struct plane *plane) {
  static const char *const AXES[] = {"x", "y", "z"};
  return json_pack("{s:s,s:s,s:s,s:o,s:[I,I],s:o}", "normal", AXES[plane->normal], "across",
                   AXES[plane->across], "up", AXES[plane->up], "at_m", json_number(plane->at),
                   "size", (json_int_t)plane->size[0], (json_int_t)plane->size[1], "spacing_m",
                   json_numbers(plane->cell, 2));
}

enum status picture_plane(const struct run *run, const struct particles *particles,
                          const struct voxel_model *model, json_t *pictures) {
  enum status status = STATUS_OK;
  const struct plane plane = choose_plane(run);
  const size_t n = plane.size[0] * plane.size[1], points = particles->count;
  const int axes[3] = {plane.across, plane.up, plane.normal};
  size_t *cell = NULL;
  float *velocity = NULL, *pressure = NULL, *soil = NULL;
  float *distance = NULL, *speed = NULL, *direction = NULL;
  double high;
  json_t *picture = plane_json(&plane);
  TRY(memory_allocate(&distance, n, sizeof *distance, "a plane"));
  TRY(memory_allocate(&speed, n, sizeof *speed, "a plane"));
  TRY(memory_allocate(&direction, 2 * n, sizeof *direction, "a plane"));
  TRY(plane_cells(&plane, particles->points, points, 0.5 * run->spacing[plane.normal], &cell));
  TRY(cells_mean(cell, points, particles->velocity, 3, n, &velocity));
  split_velocity(&plane, velocity, speed, direction);
  TRY(cells_high(speed, n, &high));
  if (!(high > 0.0)) goto cleanup;
  if (!picture_walls(model, axes, (double[3]){plane.low[0], plane.low[1], plane.at}, plane.cell,
                     plane.size, distance))
    lattice_distances(run, &plane, distance);
  json_object_set_new(picture, "distance", encode_field(distance, n, -2.0, 2.0));
  json_object_set_new(picture, "speed", encode_field(speed, n, 0.0, high));
  json_object_set_new(picture, "direction", encode_field(direction, 2 * n, -1.0, 1.0));
  if (particles->pressure != NULL) {
    TRY(cells_mean(cell, points, particles->pressure, 1, n, &pressure));
    TRY(add_pressure(run, &plane, pressure, picture));
  }
  if (particles->micro_porosity != NULL) {
    TRY(cells_mean(cell, points, particles->micro_porosity, 1, n, &soil));
    for (size_t p = 0; p < n; p++) soil[p] = soil[p] > 0.0f ? 1.0f : 0.0f;
    json_object_set_new(picture, "soil", encode_field(soil, n, 0.0, 1.0));
  }
  json_object_set(pictures, "plane", picture);
cleanup:
  json_decref(picture);
  memory_free(&cell);
  memory_free(&velocity);
  memory_free(&pressure);
  memory_free(&soil);
  memory_free(&distance);
  memory_free(&speed);
  memory_free(&direction);
  return status;
}
