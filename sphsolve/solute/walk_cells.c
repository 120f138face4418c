#include "sphsolve/solute/walk_cells.h"

#include <math.h>
#include <stdbool.h>

#include "common/memory.h"

static size_t at(const int n[3], const int x[3]) {
  return ((size_t)x[2] * (size_t)n[1] + (size_t)x[1]) * (size_t)n[0] + (size_t)x[0];
}

static size_t beside(const int n[3], const int x[3], int axis, int step) {
  int y[3] = {x[0], x[1], x[2]};
  y[axis] = (y[axis] + step + n[axis]) % n[axis];
  return at(n, y);
}

/* Change of the flux of a face along `across` over one cell. Between two open neighbours that of
 * the parabola through the three; beside a wall that to the one neighbour. No further than to where
 * the flux is 0 at an edge: water at walls does not flow back. */
static float face_slope(const struct solute_flow *f, const int x[3], int axis, int across) {
  const float *q = f->velocity[axis], *open = f->aperture[axis];
  const size_t here = at(f->n, x), low = beside(f->n, x, across, -1),
               high = beside(f->n, x, across, 1);
  if (!(open[here] > 0)) return 0;
  const bool has_low = open[low] > 0, has_high = open[high] > 0;
  const float all = (has_high ? q[high] : q[here]) - (has_low ? q[low] : q[here]);
  const float slope = has_low && has_high ? 0.5f * all : all;
  if (open[low] >= 1 && open[high] >= 1) return slope;
  const float most = 2 * fabsf(q[here]);
  return fminf(fmaxf(slope, -most), most);
}

/* Signed distance at the low corner of a cell, from the four centres along each axis (third order;
 * the mean of the eight around would move a bent wall by 1/8 of its curvature). */
static double corner_distance(const struct solute_flow *f, const int x[3]) {
  static const double weight[4] = {-0.0625, 0.5625, 0.5625, -0.0625};
  double sum = 0, least = INFINITY, most = -INFINITY;
  for (int c = 0; c < 64; c++) {
    const int step[3] = {c % 4 - 2, c / 4 % 4 - 2, c / 16 - 2};
    int y[3];
    for (int a = 0; a < 3; a++) y[a] = ((x[a] + step[a]) % f->n[a] + f->n[a]) % f->n[a];
    const double d = (double)f->distance[at(f->n, y)];
    sum += weight[step[0] + 2] * weight[step[1] + 2] * weight[step[2] + 2] * d;
    if (step[0] >= -1 && step[0] < 1 && step[1] >= -1 && step[1] < 1 && step[2] >= -1 &&
        step[2] < 1)
      least = fmin(least, d), most = fmax(most, d);
  }
  return fmin(fmax(sum, least), most);
}

static void make_velocity(const struct solute_flow *f, const int x[3], float u[WALK_TERMS][4]) {
  float slope[3][2][3], q[3][2]; /* [axis of the face][low, high][along] */
  for (int a = 0; a < 3; a++)
    for (int side = 0; side < 2; side++) {
      int y[3] = {x[0], x[1], x[2]};
      y[a] = (y[a] + side) % f->n[a];
      const float unit = (float)(f->spacing[0] / (f->spacing[a] * (f->speed > 0 ? f->speed : 1)));
      q[a][side] = unit * f->velocity[a][at(f->n, y)];
      for (int t = 0; t < 3; t++) slope[a][side][t] = t == a ? 0 : unit * face_slope(f, y, a, t);
    }
  for (int a = 0; a < 3; a++) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    u[WALK_X + b][a] = 0.5f * (slope[a][0][b] + slope[a][1][b]);
    u[WALK_X + c][a] = 0.5f * (slope[a][0][c] + slope[a][1][c]);
    u[WALK_X + a][a] = q[a][1] - q[a][0];
    u[WALK_CROSS_1][a] = slope[a][1][b] - slope[a][0][b];
    u[WALK_CROSS_2][a] = slope[a][1][c] - slope[a][0][c];
    u[WALK_SQUARE][a] = -0.5f * (slope[b][1][a] - slope[b][0][a] + slope[c][1][a] - slope[c][0][a]);
    u[WALK_0][a] = 0.5f * (q[a][0] + q[a][1]) - 0.25f * u[WALK_SQUARE][a];
  }
}

/* A cell takes part when water is in it, or when a corner of it lies in the pore of one that does:
 * the surface of the walkers and the cuts of the flow differ by a little. */
static bool takes_part(const struct solute_flow *f, const float *corners, const int x[3]) {
  if (f->volume[at(f->n, x)] > 0) return true;
  bool corner = false, near = false;
  for (int c = 0; c < 8 && !corner; c++) {
    int y[3];
    for (int a = 0; a < 3; a++) y[a] = (x[a] + (c >> a & 1)) % f->n[a];
    corner = corners[at(f->n, y)] > 0;
  }
  for (int c = 0; c < 27 && corner && !near; c++) {
    const int step[3] = {c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1};
    int y[3];
    for (int a = 0; a < 3; a++) y[a] = (x[a] + step[a] + f->n[a]) % f->n[a];
    near = f->volume[at(f->n, y)] > 0;
  }
  return near;
}

static bool near_wall(const struct walk_cells *cells, int32_t place) {
  const int *n = cells->n, x[3] = {place % n[0], place / n[0] % n[1], place / n[0] / n[1]};
  for (int c = 0; c < 27; c++) {
    const int step[3] = {c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1};
    int y[3];
    for (int a = 0; a < 3; a++) y[a] = (x[a] + step[a] + n[a]) % n[a];
    const int32_t number = cells->number[at(n, y)];
    if (number < 0 || !(cells->cell[number].least > 0)) return true;
  }
  return false;
}

#define BRICK 8 /* cells along a side */

static void next_brick(const int n[3], int brick[3]) {
  for (int a = 0; a < 3; a++) {
    brick[a] += BRICK;
    if (brick[a] < n[a] || a == 2) return;
    brick[a] = 0;
  }
}

enum status walk_cells_make(const struct solute_flow *f, struct walk_cells *cells) {
  enum status status = STATUS_OK;
  float *corners = NULL;
  *cells = (struct walk_cells){.dimensions = f->dimensions};
  for (int a = 0; a < 3; a++) {
    cells->n[a] = f->n[a], cells->spacing[a] = f->spacing[a];
    cells->stretch[a] = (float)(f->spacing[0] / f->spacing[a]);
  }
  if (f->dimensions == 2) cells->stretch[1] = 1; /* nothing varies along y */
  if (f->count >= INT32_MAX)
    return FAIL(STATUS_INPUT, "a walk counts at most %d cells, not %zu", INT32_MAX - 1, f->count);
  TRY(memory_allocate(&corners, f->count, sizeof(float), "distances of corners"));
  TRY(memory_allocate(&cells->number, f->count, sizeof(int32_t), "numbers of cells"));
  const int *n = f->n;
#pragma omp parallel for schedule(static)
  for (int k = 0; k < n[2]; k++)
    for (int j = 0; j < n[1]; j++)
      for (int i = 0; i < n[0]; i++) {
        const int x[3] = {i, j, k};
        corners[at(n, x)] = (float)(corner_distance(f, x) / f->spacing[0]);
      }
  /* Brick by brick: cells beside each other lie near each other, whichever way a walker goes. */
  for (int brick[3] = {0, 0, 0}; brick[2] < n[2]; next_brick(n, brick))
    for (int c = 0; c < BRICK * BRICK * BRICK; c++) {
      const int x[3] = {brick[0] + c % BRICK, brick[1] + c / BRICK % BRICK,
                        brick[2] + c / BRICK / BRICK};
      if (x[0] >= n[0] || x[1] >= n[1] || x[2] >= n[2]) continue;
      cells->number[at(n, x)] = takes_part(f, corners, x) ? (int32_t)cells->count++ : -1;
      cells->volume += (double)f->volume[at(n, x)];
    }
  TRY(memory_allocate(&cells->cell, cells->count, sizeof(struct walk_cell), "cells of the walk"));
  TRY(memory_allocate(&cells->corner, cells->count, sizeof *cells->corner, "corners of cells"));
  TRY(memory_allocate(&cells->place, cells->count, sizeof(int32_t), "places of cells"));
#pragma omp parallel for schedule(static)
  for (int k = 0; k < n[2]; k++)
    for (int j = 0; j < n[1]; j++)
      for (int i = 0; i < n[0]; i++) {
        const int x[3] = {i, j, k};
        const int32_t number = cells->number[at(n, x)];
        if (number < 0) continue;
        cells->place[number] = (int32_t)at(n, x);
        struct walk_cell *cell = &cells->cell[number];
        make_velocity(f, x, cell->u);
        cell->least = INFINITY;
        for (int c = 0; c < 8; c++) {
          int y[3];
          for (int a = 0; a < 3; a++) y[a] = (x[a] + (c >> a & 1)) % n[a];
          const float d = corners[at(n, y)];
          cells->corner[number][c] = d;
          cell->least = fminf(cell->least, d);
        }
      }
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < cells->count; c++) cells->cell[c].near = near_wall(cells, cells->place[c]);
  for (int a = 0; a < 3 && f->speed > 0; a++)
    for (size_t c = 0; c < f->count; c++)
      cells->fastest = fmax(cells->fastest,
                            fabs((double)f->velocity[a][c]) / f->speed * (double)cells->stretch[a]);
cleanup:
  memory_free(&corners);
  if (status != STATUS_OK) walk_cells_free(cells);
  return status;
}

void walk_cells_free(struct walk_cells *cells) {
  memory_free(&cells->cell);
  memory_free(&cells->corner);
  memory_free(&cells->number);
  memory_free(&cells->place);
  *cells = (struct walk_cells){0};
}
