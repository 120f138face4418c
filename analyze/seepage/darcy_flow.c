#include "analyze/seepage/darcy_flow.h"

#include <math.h>
#include <string.h>

#include "analyze/seepage/grid_laplace.h"
#include "common/memory.h"

enum kind { CELL_CLOSED, CELL_SOIL, CELL_HELD, CELL_WATER, CELL_AIR };

/* Properties of the run's cells, common to both grids. */
struct soil_cells {
  const struct head_field *field;
  unsigned char *kind;
  double *conductivity[2]; /* m/s along x, z */
};

/* Whether a drain prescribes the head of a cell. */
static bool is_held(const struct head_field *f, size_t c) {
  const double x[2] = {head_field_x(f, c % f->nx), head_field_z(f, c / f->nx)};
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *g = &f->regions[r];
    if (!strcmp(g->type, "drain") && x[0] > g->low[0] && x[0] < g->high[0] && x[1] > g->low[1] &&
        x[1] < g->high[1])
      return true;
  }
  return false;
}

/* Secant conductivity of i = q / K + b q
 * q
 *  (Forchheimer 1901) at the local speed of the run. */
static double conductivity_of(const struct head_field *f, size_t c, int axis) {
  const struct head_region *soil = &f->regions[f->soil[c]];
  const double speed = hypot(f->velocity[0][c], f->velocity[1][c]);
  return 1 / (1 / soil->conductivity[axis] + soil->forchheimer * speed);
}

static enum status classify_cells(const struct head_field *f, struct soil_cells *cells) {
  enum status status = STATUS_OK;
  const size_t n = f->nx * f->nz;
  cells->field = f;
  TRY(memory_allocate(&cells->kind, n, sizeof *cells->kind, "cells of soil"));
  for (int a = 0; a < 2; a++)
    TRY(memory_allocate(&cells->conductivity[a], n, sizeof **cells->conductivity, "cells of soil"));
  for (size_t c = 0; c < n; c++) {
    const bool wet = !isnan(f->head[c]);
    if (f->wall[c] != REGION_NONE) continue;
    if (f->soil[c] == REGION_NONE) {
      cells->kind[c] = wet ? CELL_WATER : CELL_AIR;
    } else if (wet) {
      cells->kind[c] = is_held(f, c) ? CELL_HELD : CELL_SOIL;
      for (int a = 0; a < 2; a++) cells->conductivity[a][c] = conductivity_of(f, c, a);
    }
  }
cleanup:
  return status;
}

/* Distance from a face of soil, in cells of free water, at which the water's head is read: outside
 * of the smeared edge. */
#define HEAD_DISTANCE_CELLS 3

/* Head prescribed at the face of soil cell c towards `side` on an axis by what is beside it; NAN if
 * none. Water prescribes its own head. A face where water may only come out, into air or a film of
 * water, is `free`: its pressure is 0. */
static double boundary_head(const struct soil_cells *cells, size_t c, int axis, int side,
                            double face_z, bool *free) {
  const struct head_field *f = cells->field;
  size_t i = c % f->nx, k = c / f->nx;
  double head = -INFINITY;
  for (int n = 0; n < HEAD_DISTANCE_CELLS; n++) {
    size_t *at = axis == 0 ? &i : &k;
    if (side < 0 ? *at == 0 : *at + 1 == (axis == 0 ? f->nx : f->nz)) break;
    *at += (size_t)side; /* wraps around for side -1 */
    const size_t b = k * f->nx + i;
    if (cells->kind[b] == CELL_AIR && n == 0) {
      *free = true;
      return side * f->velocity[axis][c] > 0 ? face_z : NAN;
    }
    if (cells->kind[b] != CELL_WATER) break;
    head = f->head[b];
  }
  *free = head <= face_z;
  return isfinite(head) ? fmax(head, face_z) : NAN;
}

/* Head prescribed by a window in the side of the domain beside soil cell c, extrapolated from the
 * heads of the run; NAN if the side is closed there. */
static double window_head(const struct soil_cells *cells, size_t c, int axis, int side) {
  const struct head_field *f = cells->field;
  const double at[2] = {head_field_x(f, c % f->nx) + (axis == 0 ? 0.5 * side * f->dx : 0),
                        head_field_z(f, c / f->nx) + (axis == 1 ? 0.5 * side * f->dz : 0)};
  /* Wraps around for side -1. */
  const size_t inner = axis == 0 ? c - (size_t)side : c - (size_t)side * f->nx;
  if (!head_field_is_open(f, at[0], at[1])) return NAN;
  if ((axis == 0 ? f->nx : f->nz) < 2 || cells->kind[inner] != CELL_SOIL) return f->head[c];
  return 1.5 * f->head[c] - 0.5 * f->head[inner];
}

/* The face of cell (i, k) of the grid towards `side` on an axis. Between two soils the resistances
 * add up: harmonic mean (Patankar 1980, 4.2-3). */
struct face {
  double weight; /* conductance, m/s */
  double head;   /* prescribed beyond the face, m; NAN if the next cell is soil too */
  bool free;     /* water may come out here, but none may go in */
};

/* A grid with cells of 1 / parts of the size of the run's cells. */
struct grid {
  const struct soil_cells *cells;
  size_t parts;
  struct grid_laplace laplace;
  /* One bit for each face of a cell: free faces that are closed because water would go in. */
  unsigned char *closed;
};

static unsigned bit_of(int axis, int side) {
  return 1u << (2 * axis + (side > 0));
}

static struct face face_of(const struct grid *grid, size_t i, size_t k, int axis, int side) {
  const struct soil_cells *cells = grid->cells;
  const size_t parts = grid->parts;
  const struct head_field *f = cells->field;
  const size_t c = k / parts * f->nx + i / parts;
  const size_t place = axis == 0 ? i : k, last = parts * (axis == 0 ? f->nx : f->nz) - 1;
  const double shape = axis == 0 ? f->dz / f->dx : f->dx / f->dz;
  const double own = cells->conductivity[axis][c];
  if (side < 0 ? place == 0 : place == last) {
    const double outside = window_head(cells, c, axis, side);
    return (struct face){isnan(outside) ? 0 : 2 * shape * own, outside, false};
  }
  const size_t to = axis == 0 ? k / parts * f->nx + (i + (size_t)side) / parts
                              : (k + (size_t)side) / parts * f->nx + i / parts;
  if (cells->kind[to] == CELL_SOIL || cells->kind[to] == CELL_HELD) {
    const double other = cells->conductivity[axis][to];
    return (struct face){2 * shape * own * other / (own + other),
                         cells->kind[to] == CELL_HELD ? f->head[to] : NAN, false};
  }
  const double z = ((double)k + (axis == 0 ? 0.5 : side > 0 ? 1.0 : 0.0)) * f->dz / (double)parts;
  bool free = false;
  const double head = boundary_head(cells, c, axis, side, z, &free);
  const bool open = !isnan(head) && !(grid->closed[k * grid->laplace.nx + i] & bit_of(axis, side));
  return (struct face){open ? 2 * shape * own : 0, open ? head : NAN, free};
}

static bool is_soil(const struct grid *grid, size_t i, size_t k) {
  const struct soil_cells *cells = grid->cells;
  return cells->kind[k / grid->parts * cells->field->nx + i / grid->parts] == CELL_SOIL;
}

/* Assembles the equations; returns whether any face prescribes a head. */
static bool assemble(struct grid *grid) {
  struct grid_laplace *g = &grid->laplace;
  bool any = false;
  memset(g->held, 0, g->nx * g->nz * sizeof *g->held);
  memset(g->source, 0, g->nx * g->nz * sizeof *g->source);
  for (size_t k = 0; k < g->nz; k++)
    for (size_t i = 0; i < g->nx; i++) {
      if (!is_soil(grid, i, k)) continue;
      const size_t n = k * g->nx + i;
      for (int axis = 0; axis < 2; axis++)
        for (int side = -1; side <= 1; side += 2) {
          const struct face face = face_of(grid, i, k, axis, side);
          if (!isnan(face.head)) {
            g->held[n] += face.weight;
            g->source[n] += face.weight * face.head;
            any = true;
          } else if (side > 0) {
            (axis == 0 ? g->along : g->upward)[n] = face.weight;
          }
        }
    }
  return any;
}

/* Closes free faces through which water goes in; returns their number. */
static size_t close_inflow_faces(struct grid *grid, const double *x) {
  size_t count = 0;
  for (size_t n = 0; n < grid->laplace.nx * grid->laplace.nz; n++)
    for (int axis = 0; axis < 2; axis++)
      for (int side = -1; side <= 1; side += 2) {
        const size_t i = n % grid->laplace.nx, k = n / grid->laplace.nx;
        if (!is_soil(grid, i, k)) continue;
        const struct face face = face_of(grid, i, k, axis, side);
        if (!face.free || !(face.weight > 0) || x[n] >= face.head) continue;
        grid->closed[n] = (unsigned char)(grid->closed[n] | bit_of(axis, side)), count++;
      }
  return count;
}

/* Sums the fluxes through the faces of the run's cells. */
static void add_fluxes(const struct grid *grid, const double *x, struct face_flux *flux) {
  const struct grid_laplace *g = &grid->laplace;
  const size_t nx = grid->cells->field->nx, parts = grid->parts;
  for (size_t k = 0; k < g->nz; k++)
    for (size_t i = 0; i < g->nx; i++) {
      if (!is_soil(grid, i, k)) continue;
      const size_t n = k * g->nx + i;
      for (int axis = 0; axis < 2; axis++)
        for (int side = -1; side <= 1; side += 2) {
          const size_t place = (axis == 0 ? i : k) + (side > 0 ? 1 : 0);
          if (place % parts != 0) continue;
          const struct face face = face_of(grid, i, k, axis, side);
          if (!(face.weight > 0) || (isnan(face.head) && side < 0)) continue;
          const double next = isnan(face.head) ? x[axis == 0 ? n + 1 : n + g->nx] : face.head;
          const double out = side * face.weight * (x[n] - next);
          if (axis == 0)
            flux->u[k / parts * (nx + 1) + place / parts] += out;
          else
            flux->w[place / parts * nx + i / parts] += out;
        }
    }
}

/* Of the residual, relative; fluxes are then accurate to about 1e-4. */
#define RESIDUAL_GOAL 1e-7

/* Iterations in which inflowing free faces are closed. */
#define FREE_FACE_ROUNDS_MAX 8

/* Solves on one grid, starting from heads `first` on the run's cells. *known: some head is
 * prescribed. */
static enum status solve(const struct soil_cells *cells, size_t parts, const double *first,
                         struct face_flux *flux, double **head, bool *known) {
  enum status status = STATUS_OK;
  const struct head_field *f = cells->field;
  const double each = 1.0 / (double)(parts * parts);
  struct grid grid = {.cells = cells, .parts = parts};
  struct grid_laplace *g = &grid.laplace;
  double *x = NULL;
  TRY(grid_laplace_create(parts * f->nx, parts * f->nz, g));
  TRY(memory_allocate(&grid.closed, g->nx * g->nz, sizeof *grid.closed, "heads of soil"));
  TRY(memory_allocate(&x, g->nx * g->nz, sizeof *x, "heads of soil"));
  TRY(memory_allocate(head, f->nx * f->nz, sizeof **head, "heads of soil"));
  TRY(memory_allocate(&flux->u, (f->nx + 1) * f->nz, sizeof *flux->u, "flow through soil"));
  TRY(memory_allocate(&flux->w, f->nx * (f->nz + 1), sizeof *flux->w, "flow through soil"));
  for (size_t n = 0; n < g->nx * g->nz; n++) {
    const size_t i = n % g->nx, k = n / g->nx;
    if (is_soil(&grid, i, k)) x[n] = first[k / parts * f->nx + i / parts];
  }
  for (int round = 0; round < FREE_FACE_ROUNDS_MAX; round++) {
    *known = assemble(&grid);
    if (!*known) break;
    TRY(grid_laplace_solve(g, RESIDUAL_GOAL, x));
    if (close_inflow_faces(&grid, x) == 0) break;
  }
  for (size_t n = 0; n < g->nx * g->nz; n++)
    (*head)[n / g->nx / parts * f->nx + n % g->nx / parts] += each * x[n];
  for (size_t c = 0; c < f->nx * f->nz; c++)
    if (cells->kind[c] != CELL_SOIL) (*head)[c] = cells->kind[c] == CELL_HELD ? f->head[c] : NAN;
  add_fluxes(&grid, x, flux);
cleanup:
  grid_laplace_free(g);
  memory_free(&grid.closed);
  memory_free(&x);
  return status;
}

/* Relative uncertainty of a flux because the position of a free surface in soil is known to half a
 * particle spacing only, on both grids alike: relative to the wet height of the column, averaged
 * over all columns. */
static double surface_share(const struct soil_cells *cells) {
  const struct head_field *f = cells->field;
  double columns = 0, free = 0;
  for (size_t i = 0; i < f->nx; i++) {
    size_t wet = 0, top = f->nz;
    for (size_t k = 0; k < f->nz; k++)
      if (cells->kind[k * f->nx + i] == CELL_SOIL) wet++, top = k;
    if (wet == 0) continue;
    columns++;
    if (top + 1 >= f->nz || f->wall[(top + 1) * f->nx + i] != REGION_NONE ||
        cells->kind[(top + 1) * f->nx + i] == CELL_WATER)
      continue;
    const double porosity = f->regions[f->soil[top * f->nx + i]].porosity;
    free += 0.5 / sqrt(porosity) / (double)wet;
  }
  return columns > 0 ? free / columns : 0;
}

static bool is_darcy(const struct head_field *f) {
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *g = &f->regions[r];
    if (!strcmp(g->type, "rain") || !strcmp(g->type, "well")) return false;
    if (!strcmp(g->type, "porous") && !(g->conductivity[0] > 0 && g->conductivity[1] > 0))
      return false;
  }
  return true;
}

enum status darcy_flow_find(const struct head_field *f, struct darcy_flow *flow) {
  enum status status = STATUS_OK;
  struct soil_cells cells = {0};
  *flow = (struct darcy_flow){.known = is_darcy(f), .field = f};
  if (!flow->known) return STATUS_OK;
  TRY(classify_cells(f, &cells));
  flow->surface = surface_share(&cells);
  for (size_t n = 0; n < 2 && flow->known; n++)
    TRY(solve(&cells, n + 1, n == 0 ? f->head : flow->level[0].head, &flow->level[n].flux,
              &flow->level[n].head, &flow->known));
cleanup:
  memory_free(&cells.kind);
  for (int a = 0; a < 2; a++) memory_free(&cells.conductivity[a]);
  if (status != STATUS_OK) darcy_flow_free(flow);
  return status;
}

void darcy_flow_free(struct darcy_flow *flow) {
  for (size_t n = 0; n < 2; n++) {
    memory_free(&flow->level[n].flux.u);
    memory_free(&flow->level[n].flux.w);
    memory_free(&flow->level[n].head);
  }
}

struct darcy_value darcy_value_of(double coarse, double fine) {
  return (struct darcy_value){2 * fine - coarse, 1.5 * fabs(fine - coarse)};
}

/* Extrapolated flux, including the uncertainty of the free surface. */
static struct darcy_value extrapolated_flux(const struct darcy_flow *flow, const double grids[2]) {
  struct darcy_value flux = darcy_value_of(grids[0], grids[1]);
  flux.error = hypot(flux.error, flow->surface * flux.value);
  return flux;
}

struct darcy_value darcy_flow_cell(const struct darcy_flow *flow, int axis, size_t c) {
  if (!flow->known) return (struct darcy_value){NAN, NAN};
  const size_t nx = flow->field->nx, left = c / nx * (nx + 1) + c % nx;
  double mean[2];
  for (size_t n = 0; n < 2; n++) {
    const struct face_flux *flux = &flow->level[n].flux;
    mean[n] = axis == 0 ? 0.5 * (flux->u[left] + flux->u[left + 1])
                        : 0.5 * (flux->w[c] + flux->w[c + nx]);
  }
  return extrapolated_flux(flow, mean);
}

struct darcy_value darcy_flow_through(const struct darcy_flow *flow, int axis, double place) {
  if (!flow->known) return (struct darcy_value){NAN, NAN};
  const struct head_field *f = flow->field;
  const size_t faces = axis == 0 ? f->nx : f->nz, along = axis == 0 ? f->nz : f->nx;
  const double at = place / (axis == 0 ? f->dx : f->dz);
  double sum[2] = {0};
  if (!(at >= 0 && at <= (double)faces)) return (struct darcy_value){NAN, NAN};
  const size_t low = at < (double)faces ? (size_t)at : faces - 1;
  const double t = at - (double)low;
  for (int n = 0; n < 2; n++)
    for (size_t m = 0; m < along; m++)
      for (size_t s = 0; s < 2; s++)
        sum[n] +=
            (s == 0 ? 1 - t : t) * (axis == 0 ? flow->level[n].flux.u[m * (f->nx + 1) + low + s]
                                              : flow->level[n].flux.w[(low + s) * f->nx + m]);
  return extrapolated_flux(flow, sum);
}

static bool is_in_drain(const struct head_field *f, size_t c, const char *name) {
  const double x[2] = {head_field_x(f, c % f->nx), head_field_z(f, c / f->nx)};
  for (size_t r = 0; r < f->region_count; r++) {
    const struct head_region *g = &f->regions[r];
    if (!strcmp(g->type, "drain") && g->name != NULL && !strcmp(g->name, name) &&
        x[0] > g->low[0] && x[0] < g->high[0] && x[1] > g->low[1] && x[1] < g->high[1])
      return true;
  }
  return false;
}

struct darcy_value darcy_flow_into_drain(const struct darcy_flow *flow, const char *name) {
  if (!flow->known) return (struct darcy_value){NAN, NAN};
  const struct head_field *f = flow->field;
  double sum[2] = {0};
  size_t cells = 0;
  for (size_t c = 0; c < f->nx * f->nz; c++) {
    if (f->soil[c] == REGION_NONE || !is_in_drain(f, c, name)) continue;
    const size_t left = c / f->nx * (f->nx + 1) + c % f->nx;
    for (int n = 0; n < 2; n++) {
      const struct face_flux *flux = &flow->level[n].flux;
      sum[n] += flux->u[left] - flux->u[left + 1] + flux->w[c] - flux->w[c + f->nx];
    }
    cells++;
  }
  return cells > 0 ? extrapolated_flux(flow, sum) : (struct darcy_value){NAN, NAN};
}

struct darcy_value darcy_flow_head(const struct darcy_flow *flow, const double at[2]) {
  if (!flow->known) return (struct darcy_value){NAN, NAN};
  const struct head_field *f = flow->field;
  const double x = at[0] / f->dx - 0.5, z = at[1] / f->dz - 0.5;
  double sum[2] = {0}, weight = 0, least = INFINITY, most = -INFINITY;
  bool border = false;
  if (!(x >= -0.5 && z >= -0.5)) return (struct darcy_value){NAN, NAN};
  const size_t home = (size_t)(z + 0.5) * f->nx + (size_t)(x + 0.5);
  if (x + 0.5 >= (double)f->nx || z + 0.5 >= (double)f->nz || isnan(flow->level[0].head[home]))
    return (struct darcy_value){NAN, NAN};
  for (int n = 0; n < 4; n++) {
    const double i = floor(x) + n % 2, k = floor(z) + n / 2;
    if (!(i >= 0 && k >= 0 && i < (double)f->nx && k < (double)f->nz)) continue;
    const size_t c = (size_t)k * f->nx + (size_t)i;
    const double w = (1 - fabs(x - i)) * (1 - fabs(z - k));
    if (!(w > 0) || isnan(flow->level[0].head[c])) continue;
    for (int l = 0; l < 2; l++) sum[l] += w * flow->level[l].head[c];
    weight += w;
    least = fmin(least, flow->level[1].head[c]), most = fmax(most, flow->level[1].head[c]);
    border = border || f->soil[c] != f->soil[home];
  }
  struct darcy_value head = darcy_value_of(sum[0] / weight, sum[1] / weight);
  head.error += flow->surface > 0 ? 0.5 * f->dz : 0;
  if (border) head.error += 0.5 * (most - least); /* the head has a kink between soils */
  return head;
}
