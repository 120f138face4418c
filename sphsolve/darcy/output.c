#include "sphsolve/darcy/output.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/output/history_columns.h"
#include "sphsolve/darcy/balance.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/edges.h"
#include "sphsolve/darcy/pond.h"

/* Sites of soil around a point, two along each used axis, with interpolation weights that add up to
 * 1. Returns their number. */
static int around(const struct richards *s, const double point[3], uint32_t site[8],
                  double weight[8]) {
  const struct lattice *l = s->lattice;
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]};
  int n = 0;
  double sum = 0;
  for (int corner = 0; corner < 8; corner++) {
    double w = 1;
    size_t at = 0;
    for (int a = 0; a < 3; a++) {
      const double x = (point[a] - l->origin[a]) / l->spacing[a], low = floor(x);
      const double side = low + (corner >> a & 1);
      w *= l->size[a] == 1 ? (corner >> a & 1) == 0 : 1 - fabs(x - side);
      const double last = (double)l->size[a] - 1;
      if (s->scene->periodic[a] && l->size[a] > 1)
        at += stride[a] * (size_t)(side < 0 ? last : side > last ? 0 : side);
      else
        at += stride[a] * (size_t)fmin(fmax(side, 0), last);
    }
    if (!(w > 0) || s->number[at] == SITE_NONE) continue;
    site[n] = s->number[at], weight[n++] = w;
    sum += w;
  }
  for (int k = 0; k < n; k++) weight[k] /= sum;
  return n;
}

/* Number of the site that counts most at a point; -1: no soil is near. */
static int64_t nearest(const struct richards *s, const double point[3]) {
  uint32_t site[8];
  double weight[8];
  const int n = around(s, point, site, weight);
  int most = 0;
  for (int k = 1; k < n; k++)
    if (weight[k] > weight[most]) most = k;
  return n > 0 ? (int64_t)site[most] : -1;
}

/* Level of the free water at a point, m; NAN if there is none, or air above it. */
static double open_level_at(const struct richards *s, const double point[3]) {
  const struct lattice *l = s->lattice;
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]};
  size_t at = 0;
  for (int a = 0; a < 3; a++) {
    const double last = (double)l->size[a] - 1, x = (point[a] - l->origin[a]) / l->spacing[a];
    at += stride[a] * (size_t)fmin(fmax(round(x), 0), last);
  }
  if (s->open == NULL || s->open[at] == 0) return NAN;
  const struct region *region = &s->scene->regions[s->open[at] - 1];
  const double level = region->type == REGION_WATER ? richards_pond_level(s, region)
                                                    : richards_head_given(region, s->time);
  return level >= point[2] ? level : NAN;
}

/* Interpolates the total head, which is uniform where water is at rest. In soil that is full it is
 * that of the nearest site and of its gradient p - (A + b |v|) v, also beside another soil. */
double richards_head_at(const struct richards *s, const double point[3]) {
  uint32_t site[8];
  double weight[8], total = 0;
  const double level = open_level_at(s, point);
  if (isfinite(level)) return -s->pull[2] * (level - point[2]);
  if (s->full) {
    const int64_t i = nearest(s, point);
    double x[3], fall[3];
    if (i < 0) return NAN;
    richards_place(s, (size_t)i, x);
    richards_fall(s, (size_t)i, fall);
    total = s->h[i];
    for (int a = 0; a < 3; a++)
      if (s->lattice->size[a] > 1) total += (s->pull[a] - fall[a]) * (point[a] - x[a]);
    return total;
  }
  const int n = around(s, point, site, weight);
  for (int k = 0; k < n; k++) {
    double x[3];
    richards_place(s, site[k], x);
    total += weight[k] * (s->h[site[k]] - s->pull[2] * x[2]);
  }
  return n > 0 ? total + s->pull[2] * point[2] : NAN;
}

double richards_level_at(const struct richards *s, const double point[3]) {
  const struct lattice *l = s->lattice;
  double at[3] = {point[0], point[1], l->origin[2]}, below = NAN;
  const double pull = -s->pull[2], open = open_level_at(s, point);
  if (isfinite(open)) return open;
  for (size_t k = 0; k < l->size[2]; k++, at[2] += l->spacing[2]) {
    const double h = richards_head_at(s, at);
    if (isnan(h)) {
      if (!isnan(below)) break; /* top of the soil */
      continue;
    }
    if (h < 0) {
      if (!isnan(below)) return at[2] - l->spacing[2] * h / (h - below);
      return pull > 0 && h > -0.5 * pull * l->spacing[2] ? at[2] + h / pull : NAN;
    }
    below = h;
  }
  return pull > 0 && !isnan(below) ? at[2] - l->spacing[2] + below / pull : NAN;
}

/* Flux through a plane, m^3/s along the axis, interpolated linearly between the layers of faces
 * beside it. */
static double plane_flux(const struct richards *s, const struct flux_plane *plane) {
  double sum = 0;
  const struct lattice *l = s->lattice;
  const int axis = plane->axis;
  const double at = plane->position / s->spacing;
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]}, n = l->size[axis];
  for (size_t f = 0; f < s->face_count; f++) {
    const struct richards_face *face = &s->faces[f];
    if (face->axis != axis) continue;
    const double layer = (double)(s->site[face->i] / stride[axis] % n) + 1;
    sum += fmax(0, 1 - fabs(at - layer)) * s->face_flux[f].q;
    if (s->scene->periodic[axis] && layer == (double)n) /* the same face, at the low end */
      sum += fmax(0, 1 - fabs(at)) * s->face_flux[f].q;
  }
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    if (edge->axis != axis || !richards_is_face(edge)) continue;
    const double layer = (double)(s->site[edge->site] / stride[axis] % n) + (edge->low ? 0 : 1);
    sum += fmax(0, 1 - fabs(at - layer)) * (edge->low ? 1 : -1) * s->edge_flux[e].q;
  }
  return sum * s->spacing * s->spacing;
}

/* Whether a region has columns in the history: the first box of an inflow, a rain, a well, a drain
 * or a body of water. */
static bool is_source(const struct richards *s, size_t r) {
  const struct region *region = &s->scene->regions[r];
  return region->first == r &&
         (region->type == REGION_INFLOW || region->type == REGION_RAIN || region_is_sink(region) ||
          (region->type == REGION_WATER && isfinite(richards_pond_level(s, region))));
}

/* Inward flux through the faces of a region, m^3/s; of a face that it shares, in proportion to what
 * is given there. */
static double flow_of(const struct richards *s, size_t r) {
  double sum = 0;
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    const double q = s->edge_flux[e].q,
                 rained = richards_is_covered(s, edge, s->time) ? 0 : fmax(q, 0);
    double own = 0, all = 0;
    for (size_t k = 0; k < edge->source_count; k++) {
      const struct richards_source *source = &s->sources[edge->source + k];
      const double given = richards_source_at(source, s->time);
      all += given;
      if (source->region->first == r) own += given;
    }
    if (edge->region != NULL && edge->region->first == r)
      sum += edge->source_count > 0 ? q - rained : q;
    if (own > 0) sum += own / all * (edge->region == NULL ? q : rained);
  }
  return sum * s->spacing * s->spacing;
}

/* Water content at a point with the given pressure head, for the soil of the nearest site. */
static double water_content_at(const struct richards *s, const double point[3], double head) {
  struct retention_state state;
  const int64_t i = nearest(s, point);
  if (isfinite(open_level_at(s, point))) return 1;
  if (i < 0) return NAN;
  retention_at(&s->soils[s->soil[i]], head, &state);
  return state.theta;
}

/* Total head z + P/(rho g), m, with the scene's own gravity; the pressure head h is relative to
 * 9.80665 m/s^2. */
static double total_head(const struct richards *s, double h, double z) {
  const double pull = -s->pull[2];
  return pull > 0 ? z + h / pull : h + pull * z;
}

static void walk_region(struct history_columns *columns, const struct richards *s, size_t r) {
  const struct region *region = &s->scene->regions[r];
  const double density = s->scene->fluid.density;
  const size_t number = region->number + 1;
  if (region->type == REGION_INFLOW) {
    history_number(columns, "m^3/s", flow_of(s, r), "inflow_%zu", number);
    history_number(columns, "m^3", s->entered[r], "entered_%zu", number);
  } else if (region->type == REGION_WATER) {
    history_number(columns, "m^3/s", flow_of(s, r), "infiltration_%zu", number);
    history_number(columns, "m^3", richards_pond_volume(s, region), "volume_%zu", number);
    history_number(columns, "m^3", s->ran_off[r], "ran_off_%zu", number);
  } else if (region_is_sink(region)) {
    history_number(columns, "m^3/s", 0 - flow_of(s, r), "outflow_%s", region->name);
    history_number(columns, "kg", 0 - density * s->entered[r], "taken_%s", region->name);
  } else {
    history_number(columns, "m^3/s", flow_of(s, r), "infiltration_%s", region->name);
    history_number(columns, "kg", density * s->rained[r], "fallen_%s", region->name);
    history_number(columns, "kg", density * s->ran_off[r], "ran_off_%s", region->name);
    if (region->ponding > 0)
      history_number(columns, "kg", density * richards_pond_volume(s, region), "ponded_%s",
                     region->name);
  }
}

/* Up to where water comes out of soil to the air, m: the upper end of the highest face that lets
 * some out. NAN: nowhere. */
static void seepage_top(const struct richards *s, double top[3]) {
  for (int a = 0; a < 3; a++) top[a] = NAN;
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    const double least = RATE_ROUNDING * s->soils[s->soil[edge->site]].conductivity[edge->axis];
    const double z = edge->z + (edge->axis == 2 ? 0 : 0.5 * s->spacing);
    const bool air = edge->kind == EDGE_AIR || edge->kind == EDGE_HEAD || edge->kind == EDGE_POOL;
    if (!air || !(s->edge_flux[e].q < -least) || z <= top[2] ||
        richards_is_covered(s, edge, s->time))
      continue;
    richards_place(s, edge->site, top);
    top[edge->axis] += (edge->low ? -0.5 : 0.5) * s->spacing;
    top[2] = z;
  }
}

/* The columns beyond those of every method. */
static void walk_columns(struct history_columns *columns, const void *state) {
  const struct richards *s = state;
  const struct scene *scene = s->scene;
  const double water = richards_water(s), weight = scene->fluid.density * GRAVITY_STANDARD;
  double least = INFINITY, most = -INFINITY, top[3];
  for (size_t i = 0; i < s->count; i++)
    if (s->lattice->kind[s->site[i]] != SITE_WALL)
      least = fmin(least, s->h[i]), most = fmax(most, s->h[i]);
  history_number(columns, "m^3", water, "water");
  history_number(columns, "m^3", water - s->start - richards_net_inflow(s), "water_open");
  history_number(columns, "m^3", s->seeped, "seeped_to_air");
  if (!s->full) seepage_top(s, top), history_column(columns, "m", 3, top, "seepage_top");
  history_number(columns, "m", least, "pressure_head_least");
  history_number(columns, "m", most, "pressure_head_most");
  history_number(columns, "1", s->iterations, "iterations");
  for (size_t r = 0; r < scene->region_count; r++)
    if (is_source(s, r)) walk_region(columns, s, r);
  for (size_t k = 0; k < scene->gauge_count; k++) {
    const char *name = scene->gauges[k].name;
    const double *at = scene->gauges[k].at, h = richards_head_at(s, at);
    history_number(columns, "Pa", weight * h, "pressure_%s", name);
    history_number(columns, "m", total_head(s, h, at[2]), "head_%s", name);
    if (s->full) {
      const int64_t i = nearest(s, at);
      double v[3] = {NAN, NAN, NAN};
      if (i >= 0) richards_velocity(s, (size_t)i, v);
      history_column(columns, "m/s", 3, v, "velocity_%s", name);
      continue;
    }
    history_number(columns, "1", water_content_at(s, at, h), "water_content_%s", name);
    history_number(columns, "m", richards_level_at(s, at), "level_%s", name);
  }
  for (size_t k = 0; k < scene->plane_count; k++)
    history_number(columns, "m^3/s", plane_flux(s, &scene->planes[k]), "flux_%s",
                   scene->planes[k].name);
}

enum status richards_add_columns(const struct richards *s, struct recorder *recorder) {
  return history_columns_declare(recorder, walk_columns, s);
}

enum status richards_write_row(struct richards *s, struct recorder *recorder, double dt) {
  const double density = s->scene->fluid.density;
  struct history_row row = {.time = s->time,
                            .step = s->step,
                            .dt = dt,
                            .reynolds = NAN,
                            .density_max = density,
                            .density_mean = density};
  richards_evaluate(s, s->time);
  row.mass = density * richards_water(s);
  for (size_t i = 0; i < s->count; i++) {
    double v[3];
    richards_flow(s, i, v);
    for (int a = 0; a < 3; a++) row.darcy_velocity[a] += v[a] / s->lattice->bulk_count;
  }
  return history_columns_row(recorder, &row, walk_columns, s);
}

enum status richards_write_snapshot(struct richards *s, struct recorder *recorder) {
  enum status status = STATUS_OK;
  const double weight = s->scene->fluid.density * GRAVITY_STANDARD;
  double(*place)[3] = NULL, (*velocity)[3] = NULL, *values[4] = {NULL};
  size_t count = 0;
  TRY(memory_allocate(&place, s->count, sizeof *place, "a snapshot"));
  TRY(memory_allocate(&velocity, s->count, sizeof *velocity, "a snapshot"));
  for (int k = 0; k < 4; k++)
    TRY(memory_allocate(&values[k], s->count, sizeof(double), "a snapshot"));
  richards_evaluate(s, s->time);
  for (size_t i = 0; i < s->count; i++) {
    if (s->lattice->kind[s->site[i]] == SITE_WALL) continue; /* its centre is in a wall */
    richards_place(s, i, place[count]);
    richards_velocity(s, i, velocity[count]);
    values[0][count] = weight * s->h[i];
    values[1][count] = total_head(s, s->h[i], place[count][2]);
    values[2][count] = s->now[i].theta;
    values[3][count] = s->now[i].theta / s->soils[s->soil[i]].theta_s;
    count++;
  }
  const struct snapshot_field at = {.type = H5_F64, .components = 3, .data = place},
                              fields[] = {
                                  {"velocity", "m/s", "Darcy velocity", H5_F64, 3, velocity, NULL,
                                   NULL},
                                  {"pressure", "Pa", "pressure, below 0 where soil draws water",
                                   H5_F64, 1, values[0], NULL, NULL},
                                  {"head", "m", "total head", H5_F64, 1, values[1], NULL, NULL},
                                  {"porosity", "1", "porosity; 1 in free water", H5_F64, 1,
                                   values[2], NULL, NULL},
                                  {"water_content", "1", "water over bulk volume", H5_F64, 1,
                                   values[2], NULL, NULL},
                                  {"saturation", "1", "water content over that of full soil",
                                   H5_F64, 1, values[3], NULL, NULL}};
  /* `porosity` ends those of soil that is full, and the others do not have it. */
  struct snapshot_field shown[6];
  size_t shown_count = 0;
  for (size_t k = 0; k < sizeof fields / sizeof *fields; k++)
    if (s->full ? k < 4 : k != 3) shown[shown_count++] = fields[k];
  TRY(recorder_snapshot(recorder, s->time, s->step, count, &at, shown_count, shown));
cleanup:
  for (int k = 0; k < 4; k++) memory_free(&values[k]);
  memory_free(&velocity);
  memory_free(&place);
  return status;
}

/* The numbers and arrays of a checkpoint, in one order for writing and reading. */
#define NUMBERS 8
static double *number_at(struct richards *s, int k) {
  double *const numbers[NUMBERS] = {&s->time, &s->next_dt, &s->start, &s->seeped,
                                    &s->in,   &s->out,     &s->rate,  &s->rate_most};
  return numbers[k];
}

#define ARRAYS 6
static double *array_at(struct richards *s, int k, const char **name, size_t *count) {
  static const char *const names[ARRAYS] = {"/state/pressure_head", "/state/water",
                                            "/state/entered",       "/state/rained",
                                            "/state/ran_off",       "/state/volume"};
  double *const arrays[ARRAYS] = {s->h,      s->water,   s->entered,
                                  s->rained, s->ran_off, s->pool_volumes};
  *name = names[k];
  *count = k < 2 ? s->count : k < 5 ? s->scene->region_count : s->pool_count;
  return arrays[k];
}

enum status richards_write_checkpoint(const struct richards *s, struct recorder *recorder) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  struct richards *of = (struct richards *)s; /* only read */
  double numbers[NUMBERS];
  const int64_t counts[6] = {s->step,         s->iterations, s->iterations_total,
                             s->linear_total, s->refused,    s->short_steps};
  TRY(recorder_checkpoint_begin(recorder, &file));
  for (int k = 0; k < ARRAYS; k++) {
    const char *name;
    size_t count;
    const double *array = array_at(of, k, &name, &count);
    if (array == NULL) continue;
    TRY(h5_write(file, name, H5_F64, 1, &count, array, true));
  }
  for (int k = 0; k < NUMBERS; k++) numbers[k] = *number_at(of, k);
  TRY(h5_write_attribute(file, "/state", "numbers", H5_F64, NUMBERS, numbers));
  TRY(h5_write_attribute(file, "/state", "counts", H5_I64, 6, counts));
  status = recorder_checkpoint_commit(recorder, file); /* takes the file over */
  file = NULL;
cleanup:
  h5_close(file);
  return status;
}

enum status richards_read_checkpoint(struct richards *s, struct h5_file *file) {
  enum status status = STATUS_OK;
  double numbers[NUMBERS], *data = NULL;
  int64_t counts[6];
  for (int k = 0; k < ARRAYS; k++) {
    const char *name;
    size_t count, there;
    double *array = array_at(s, k, &name, &count);
    if (array == NULL) continue;
    TRY(h5_read(file, name, H5_F64, 1, &there, &data));
    if (there != count)
      TRY_FAIL(STATUS_INPUT, "%s: %s is of another scene; remove the file to start anew",
               h5_path(file), name);
    memcpy(array, data, count * sizeof *array);
    memory_free(&data);
  }
  TRY(h5_read_attribute(file, "/state", "numbers", H5_F64, NUMBERS, numbers));
  for (int k = 0; k < NUMBERS; k++) *number_at(s, k) = numbers[k];
  TRY(h5_read_attribute(file, "/state", "counts", H5_I64, 6, counts));
  s->step = counts[0], s->iterations = (int)counts[1], s->iterations_total = counts[2];
  s->linear_total = counts[3], s->refused = counts[4], s->short_steps = counts[5];
cleanup:
  memory_free(&data);
  return status;
}
