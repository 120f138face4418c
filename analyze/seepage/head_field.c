#include "analyze/seepage/head_field.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/snapshot_file.h"

static enum status read_regions(const struct run *run, struct h5_file *file, struct head_field *f,
                                double domain[3]) {
  enum status status = STATUS_OK;
  double *boxes = NULL, *porosity = NULL, *permeability = NULL, *law = NULL, gravity[3];
  double *head = NULL;
  char **types = NULL, **names = NULL;
  uint64_t *numbers = NULL;
  size_t dims[2], n = 0, named = 0;
  if (!h5_exists(file, "/run/regions"))
    TRY_FAIL(STATUS_INPUT, "%s: the run keeps no regions (%s); run it again with this version",
             run->path,
             *run->model_path ? "it is that of a voxel model" : "it is of an older version");
  TRY(h5_read_texts(file, "/run/regions/type", &n, &types));
  f->region_count = n;
  TRY(memory_allocate(&f->regions, n, sizeof *f->regions, "regions"));
  for (size_t k = 0; k < n; k++) f->regions[k].type = types[k], types[k] = NULL;
  if (h5_exists(file, "/run/regions/name")) {
    TRY(h5_read_texts(file, "/run/regions/name", &named, &names));
    if (named != n) TRY_FAIL(STATUS_INPUT, "%s: /run/regions/name is damaged", run->path);
    for (size_t k = 0; k < n; k++) f->regions[k].name = names[k], names[k] = NULL;
  }
  dims[0] = n;
  if (h5_exists(file, "/run/regions/number"))
    TRY(h5_read(file, "/run/regions/number", H5_U64, 1, dims, &numbers));
  if (dims[0] != n) TRY_FAIL(STATUS_INPUT, "%s: /run/regions/number is damaged", run->path);
  for (size_t k = 0; k < n; k++) f->regions[k].number = numbers != NULL ? (size_t)numbers[k] : k;
  dims[0] = n, dims[1] = 6;
  TRY(h5_read(file, "/run/regions/box", H5_F64, 2, dims, &boxes));
  if (dims[0] != n || dims[1] != 6)
    TRY_FAIL(STATUS_INPUT, "%s: /run/regions/box is damaged", run->path);
  dims[0] = n;
  TRY(h5_read(file, "/run/regions/porosity", H5_F64, 1, dims, &porosity));
  if (dims[0] != n) TRY_FAIL(STATUS_INPUT, "%s: /run/regions/porosity is damaged", run->path);
  TRY(h5_read(file, "/run/regions/permeability", H5_F64, 1, dims, &permeability));
  if (dims[0] != n) TRY_FAIL(STATUS_INPUT, "%s: /run/regions/permeability is damaged", run->path);
  for (size_t k = 0; k < n; k++)
    for (int a = 0; a < 2; a++) {
      f->regions[k].low[a] = boxes[6 * k + (a == 0 ? 0 : 2)];
      f->regions[k].high[a] = boxes[6 * k + (a == 0 ? 3 : 5)];
      f->regions[k].porosity = porosity[k], f->regions[k].permeability = permeability[k];
    }
  dims[0] = n, dims[1] = 3;
  if (h5_exists(file, "/run/regions/darcy_x_z_forchheimer"))
    TRY(h5_read(file, "/run/regions/darcy_x_z_forchheimer", H5_F64, 2, dims, &law));
  if (dims[0] != n || dims[1] != 3)
    TRY_FAIL(STATUS_INPUT, "%s: /run/regions/darcy_x_z_forchheimer is damaged", run->path);
  for (size_t k = 0; k < n; k++) {
    struct head_region *r = &f->regions[k];
    for (size_t a = 0; a < 2; a++) r->conductivity[a] = law != NULL ? law[3 * k + a] : NAN;
    r->forchheimer = law != NULL ? law[3 * k + 2] : NAN;
  }
  dims[0] = n;
  if (h5_exists(file, "/run/regions/head"))
    TRY(h5_read(file, "/run/regions/head", H5_F64, 1, dims, &head));
  if (dims[0] != n) TRY_FAIL(STATUS_INPUT, "%s: /run/regions/head is damaged", run->path);
  for (size_t k = 0; k < n; k++) f->regions[k].head = head != NULL ? head[k] : NAN;
  TRY(h5_read_attribute(file, "/run/regions", "domain", H5_F64, 3, domain));
  TRY(h5_read_attribute(file, "/run/regions", "gravity", H5_F64, 3, gravity));
  if (!(gravity[2] < 0 && gravity[0] == 0 && gravity[1] == 0))
    TRY_FAIL(STATUS_INPUT, "%s: heads need gravity along -z; the scene has (%g, %g, %g) m/s^2",
             run->path, gravity[0], gravity[1], gravity[2]);
  f->gravity = -gravity[2];
cleanup:
  h5_free_texts(n, &types);
  h5_free_texts(named, &names);
  memory_free(&numbers);
  memory_free(&boxes);
  memory_free(&porosity);
  memory_free(&permeability);
  memory_free(&law);
  memory_free(&head);
  return status;
}

bool head_region_is_sink(const struct head_region *region) {
  return !strcmp(region->type, "well") || !strcmp(region->type, "drain");
}

bool head_region_is_source(const struct head_region *region) {
  return head_region_is_sink(region) || !strcmp(region->type, "rain");
}

bool head_field_is_open(const struct head_field *f, double x, double z) {
  const double near = 1e-3 * fmin(f->dx, f->dz);
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *g = &f->regions[r];
    if (!strcmp(g->type, "inflow") && x >= g->low[0] - near && x <= g->high[0] + near &&
        z >= g->low[1] - near && z <= g->high[1] + near)
      return true;
  }
  return false;
}

/* Later regions replace earlier ones. Soil may contain water, so that water does not replace it. */
static enum status mark_cells(struct head_field *f) {
  enum status status = STATUS_OK;
  const size_t cells = f->nx * f->nz;
  TRY(memory_allocate(&f->soil, cells, sizeof *f->soil, "cells"));
  TRY(memory_allocate(&f->wall, cells, sizeof *f->wall, "cells"));
  for (size_t c = 0; c < cells; c++) {
    const double x[2] = {head_field_x(f, c % f->nx), head_field_z(f, c / f->nx)};
    f->soil[c] = f->wall[c] = REGION_NONE;
    for (size_t k = 0; k < f->region_count && k < REGION_NONE; k++) {
      const struct head_region *r = &f->regions[k];
      if (!(x[0] > r->low[0] && x[0] < r->high[0] && x[1] > r->low[1] && x[1] < r->high[1]))
        continue;
      if (!strcmp(r->type, "porous")) f->soil[c] = (uint16_t)k, f->wall[c] = REGION_NONE;
      if (!strcmp(r->type, "wall")) f->wall[c] = (uint16_t)k, f->soil[c] = REGION_NONE;
    }
  }
cleanup:
  return status;
}

/* Sums of a moving least squares fit at one cell (Lancaster, Salkauskas 1981, Math. Comp. 37, 141):
 * a plane through the nearby particles. */
struct sums {
  double basis[6];    /* 1 x z xx xz zz */
  double value[3][3]; /* of head, v_x, v_z times 1 x z */
  double filled;
};

/* Whether a wall is between two points; particles behind a wall are not used. */
static bool is_hidden(const struct head_field *f, const double from[2], const double to[2]) {
  const double length = hypot(to[0] - from[0], to[1] - from[1]);
  const int steps = (int)ceil(length / (0.25 * fmin(f->dx, f->dz)));
  for (int s = 1; s < steps; s++) {
    const double x = from[0] + (to[0] - from[0]) * s / steps;
    const double z = from[1] + (to[1] - from[1]) * s / steps;
    if (!(x > 0 && z > 0)) continue;
    const size_t i = (size_t)(x / f->dx), k = (size_t)(z / f->dz);
    if (i < f->nx && k < f->nz && f->wall[k * f->nx + i] != REGION_NONE) return true;
  }
  return false;
}

/* Support radius of the fit over the particle size: about 20 neighbours. */
#define SUPPORT_RATIO 2.4
/* Volume fraction of water around a cell's centre below which the cell counts as dry. */
#define FILLED_MIN 0.35

static void scatter(const struct head_field *f, const double x[2], double size,
                    const double value[3], struct sums *sums) {
  const double h = SUPPORT_RATIO * size;
  const size_t i0 = (size_t)fmax(0, floor((x[0] - h) / f->dx));
  const size_t k0 = (size_t)fmax(0, floor((x[1] - h) / f->dz));
  for (size_t k = k0; k < f->nz && head_field_z(f, k) < x[1] + h; k++)
    for (size_t i = i0; i < f->nx && head_field_x(f, i) < x[0] + h; i++) {
      const double at[2] = {head_field_x(f, i), head_field_z(f, k)};
      const double r[2] = {(x[0] - at[0]) / h, (x[1] - at[1]) / h};
      const double q = r[0] * r[0] + r[1] * r[1];
      if (q >= 1 || f->wall[k * f->nx + i] != REGION_NONE || is_hidden(f, at, x)) continue;
      struct sums *s = &sums[k * f->nx + i];
      const double w = (1 - q) * (1 - q) * (1 - q);
      const double b[3] = {1, r[0], r[1]};
      for (int p = 0, m = 0; p < 3; p++)
        for (int c = p; c < 3; c++) s->basis[m++] += w * b[p] * b[c];
      for (int v = 0; v < 3; v++)
        for (int p = 0; p < 3; p++) s->value[v][p] += w * b[p] * value[v];
      s->filled += w * 4 / M_PI /
                   (SUPPORT_RATIO * SUPPORT_RATIO); /* integral of w over the support: pi h^2 / 4 */
    }
}

/* The values of the cell around x. */
static void put(const struct head_field *f, const double x[2], const double value[3],
                struct sums *sums) {
  if (!(x[0] >= 0 && x[1] >= 0)) return;
  const size_t i = (size_t)(x[0] / f->dx), k = (size_t)(x[1] / f->dz);
  if (i >= f->nx || k >= f->nz) return;
  struct sums *s = &sums[k * f->nx + i];
  s->basis[0] = s->filled = 1;
  for (int v = 0; v < 3; v++) s->value[v][0] = value[v];
}

/* Fitted value at the cell's centre, exact for linear fields; the weighted mean if there are too
 * few particles. */
static double fit(const struct sums *s, int v) {
  const double *m = s->basis, *y = s->value[v];
  const double c00 = m[3] * m[5] - m[4] * m[4], c01 = m[2] * m[4] - m[1] * m[5],
               c02 = m[1] * m[4] - m[2] * m[3];
  const double determinant = m[0] * c00 + m[1] * c01 + m[2] * c02;
  if (!(determinant > 1e-4 * m[0] * m[0] * m[0])) return y[0] / m[0];
  return (c00 * y[0] + c01 * y[1] + c02 * y[2]) / determinant;
}

/* Adds a snapshot. A cell without water in any of the snapshots stays NAN. */
static enum status add_snapshot(const struct run *run, const char *name, struct head_field *f) {
  enum status status = STATUS_OK;
  struct snapshot snapshot = {0};
  struct sums *sums = NULL;
  char path[8192];
  double *velocity = NULL, *pressure = NULL, *volume = NULL;
  const bool fixed = strcmp(run->method, "darcy") == 0; /* a point in each cell */
  if (snprintf(path, sizeof path, "%s%s", run->folder, name) >= (int)sizeof path)
    TRY_FAIL(STATUS_INPUT, "%s: the name of a snapshot is too long", run->path);
  TRY(memory_allocate(&sums, f->nx * f->nz, sizeof *sums, "the field of heads"));
  TRY(snapshot_open(path, &snapshot));
  TRY(snapshot_read(&snapshot, "velocity", 3, &velocity));
  TRY(snapshot_read(&snapshot, "pressure", 1, &pressure));
  if (!fixed) TRY(snapshot_read(&snapshot, "volume", 1, &volume));
  for (size_t i = 0; i < snapshot.count; i++) {
    const double *p = snapshot.points + 3 * i, x[2] = {p[0], p[2]};
    const double size = fixed ? f->dx : sqrt(volume[i] / f->thickness);
    const double value[3] = {p[2] + pressure[i] / (f->density * f->gravity), velocity[3 * i],
                             velocity[3 * i + 2]};
    if (!isfinite(value[0]) || !isfinite(value[1]) || !isfinite(value[2]) || !(size > 0) ||
        !isfinite(x[0]) || !isfinite(x[1]) || size > 1e3 * f->dx)
      TRY_FAIL(STATUS_INPUT, "%s: particle %zu has a value that is not finite", path, i);
    if (fixed)
      put(f, x, value, sums);
    else
      scatter(f, x, size, value, sums);
  }
  double speed = 0, soil = 0;
  for (size_t c = 0; c < f->nx * f->nz; c++) {
    const bool wet = sums[c].filled > FILLED_MIN;
    const double v[2] = {wet ? fit(&sums[c], 1) : NAN, wet ? fit(&sums[c], 2) : NAN};
    f->head[c] += wet ? fit(&sums[c], 0) : NAN;
    for (int a = 0; a < 2; a++) f->velocity[a][c] += v[a];
    if (wet && f->soil[c] != REGION_NONE) speed += hypot(v[0], v[1]), soil++;
  }
  f->speed[f->snapshots++] = soil > 0 ? speed / soil : 0;
cleanup:
  snapshot_close(&snapshot);
  memory_free(&sums);
  memory_free(&velocity);
  memory_free(&pressure);
  memory_free(&volume);
  return status;
}

bool head_field_is_seepage(const struct run *run) {
  return strcmp(run->method, "isph") == 0 || strcmp(run->method, "darcy") == 0;
}

enum status head_field_read(const struct run *run, struct head_field *f) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  double domain[3];
  *f = (struct head_field){.density = run->density, .thickness = run->spacing[1]};
  if (!head_field_is_seepage(run))
    TRY_FAIL(STATUS_INPUT, "%s: a run of %s; seepage is computed by method isph or darcy",
             run->path, run->method);
  if (run->dimensions != 2)
    TRY_FAIL(STATUS_INPUT, "%s: flow nets are of 2-D scenes; this one has 3 dimensions", run->path);
  if (run->snapshot_count == 0)
    TRY_FAIL(STATUS_INPUT, "%s: the run lists no snapshots; run it again to its end", run->path);
  TRY(h5_open(run->path, &file));
  TRY(read_regions(run, file, f, domain));
  f->nx = (size_t)fmax(1, round(domain[0] / run->spacing[0]));
  f->nz = (size_t)fmax(1, round(domain[2] / run->spacing[2]));
  if (!(domain[0] > 0 && domain[2] > 0) || f->nx > 100000 || f->nz > 100000)
    TRY_FAIL(STATUS_INPUT, "%s: the domain of /run/regions is damaged", run->path);
  f->dx = domain[0] / (double)f->nx, f->dz = domain[2] / (double)f->nz;
  TRY(mark_cells(f));
  TRY(memory_allocate(&f->head, f->nx * f->nz, sizeof *f->head, "the field of heads"));
  for (int a = 0; a < 2; a++)
    TRY(memory_allocate(&f->velocity[a], f->nx * f->nz, sizeof **f->velocity, "velocities"));
  TRY(memory_allocate(&f->speed, run->snapshot_count, sizeof *f->speed, "velocities"));
  f->to = run->snapshot_times[run->snapshot_count - 1], f->from = f->to;
  for (size_t s = 0; s < run->snapshot_count; s++) {
    if (run->snapshot_times[s] < 0.5 * f->to) continue;
    f->from = fmin(f->from, run->snapshot_times[s]);
    TRY(add_snapshot(run, run->snapshot_names[s], f));
  }
  for (size_t c = 0; c < f->nx * f->nz; c++) {
    f->head[c] /= (double)f->snapshots;
    for (int a = 0; a < 2; a++) f->velocity[a][c] /= (double)f->snapshots;
  }
cleanup:
  h5_close(file);
  if (status != STATUS_OK) head_field_free(f);
  return status;
}

void head_field_free(struct head_field *f) {
  for (size_t k = 0; f->regions != NULL && k < f->region_count; k++)
    memory_free(&f->regions[k].type), memory_free(&f->regions[k].name);
  memory_free(&f->regions);
  memory_free(&f->soil);
  memory_free(&f->wall);
  memory_free(&f->head);
  memory_free(&f->velocity[0]);
  memory_free(&f->velocity[1]);
  memory_free(&f->speed);
}

/* Tolerance of heads, in spacings. Still water with a depth of a whole number of particle rows has
 * its head within 0.02, except beside walls. The head of a shallow one that ends within a row is up
 * to 0.4 off. */
#define HEAD_TOLERANCE 0.1

static bool is_water(const struct head_field *f, size_t c) {
  return f->soil[c] == REGION_NONE && f->wall[c] == REGION_NONE && !isnan(f->head[c]);
}

static bool contains_cell(const struct head_region *window, const struct head_field *f, size_t c) {
  const double x = head_field_x(f, c % f->nx), z = head_field_z(f, c / f->nx);
  return x > window->low[0] && x < window->high[0] && z > window->low[1] && z < window->high[1];
}

/* Adds cell c to a connected body of water; false if it is not free water or already included. */
static bool add_cell(const struct head_field *f, size_t c, unsigned char *body, size_t *list,
                     size_t *count) {
  if (body[c] || !is_water(f, c)) return false;
  body[c] = 1;
  list[(*count)++] = c;
  return true;
}

/* Lists the cells of the free water connected to a window; returns their number. */
static size_t find_body(const struct head_field *f, const struct head_region *window,
                        unsigned char *body, size_t *list) {
  size_t count = 0;
  memset(body, 0, f->nx * f->nz);
  for (size_t c = 0; c < f->nx * f->nz; c++)
    if (contains_cell(window, f, c)) add_cell(f, c, body, list, &count);
  for (size_t n = 0; n < count; n++) {
    const size_t c = list[n], i = c % f->nx, k = c / f->nx;
    if (i > 0) add_cell(f, c - 1, body, list, &count);
    if (i + 1 < f->nx) add_cell(f, c + 1, body, list, &count);
    if (k > 0) add_cell(f, c - f->nx, body, list, &count);
    if (k + 1 < f->nz) add_cell(f, c + f->nx, body, list, &count);
  }
  return count;
}

/* Whether another window, with a different or changing head, is connected to the same water. */
static bool is_shared(const struct head_field *f, const struct head_region *window,
                      const size_t *list, size_t count) {
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *other = &f->regions[r];
    if (strcmp(other->type, "inflow") != 0 || other->head == window->head) continue;
    for (size_t n = 0; n < count; n++)
      if (contains_cell(other, f, list[n])) return true;
  }
  return false;
}

/* Prescribes the head of a window in its water, if that is still: the standard deviation of its
 * heads is within the tolerance. Beside walls the heads are less accurate, with few particles. */
static void prescribe_water_head(const struct head_field *f, const struct head_region *window,
                                 const size_t *list, size_t count, struct asked_heads *asked) {
  double mean = 0, square = 0;
  for (size_t n = 0; n < count; n++) mean += f->head[list[n]] / (double)count;
  for (size_t n = 0; n < count; n++) square += pow(f->head[list[n]] - mean, 2) / (double)count;
  if (sqrt(square) > HEAD_TOLERANCE * f->dz) return;
  for (size_t n = 0; n < count; n++) asked->head[list[n]] = window->head;
  const double off = fabs(mean - window->head);
  if (off <= HEAD_TOLERANCE * f->dz ||
      (!asked->reached && off <= fabs(asked->found - asked->prescribed)))
    return;
  asked->reached = false;
  asked->window = window->number, asked->found = mean, asked->prescribed = window->head;
}

/* A drain prescribes the pressure max(0, rho g (head - z)), except in cells with a lower
 * pressure. */
static void prescribe_drain_head(const struct head_field *f, const struct head_region *drain,
                                 double *head) {
  for (size_t c = 0; c < f->nx * f->nz; c++) {
    const double held = fmax(drain->head, head_field_z(f, c / f->nx));
    if (contains_cell(drain, f, c) && f->head[c] > held - HEAD_TOLERANCE * f->dz) head[c] = held;
  }
}

enum status asked_heads_find(const struct head_field *f, struct asked_heads *asked) {
  enum status status = STATUS_OK;
  const size_t cells = f->nx * f->nz;
  unsigned char *body = NULL;
  size_t *list = NULL;
  *asked = (struct asked_heads){.reached = true};
  TRY(memory_allocate(&asked->head, cells, sizeof *asked->head, "heads"));
  TRY(memory_allocate(&body, cells, sizeof *body, "free water"));
  TRY(memory_allocate(&list, cells, sizeof *list, "free water"));
  memcpy(asked->head, f->head, cells * sizeof *asked->head);
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *region = &f->regions[r];
    if (isnan(region->head)) continue;
    if (!strcmp(region->type, "drain")) prescribe_drain_head(f, region, asked->head);
    if (strcmp(region->type, "inflow") != 0) continue;
    const size_t count = find_body(f, region, body, list);
    if (count > 0 && !is_shared(f, region, list, count))
      prescribe_water_head(f, region, list, count, asked);
  }
cleanup:
  memory_free(&body);
  memory_free(&list);
  if (status != STATUS_OK) asked_heads_free(asked);
  return status;
}

void asked_heads_free(struct asked_heads *asked) {
  memory_free(&asked->head);
}
