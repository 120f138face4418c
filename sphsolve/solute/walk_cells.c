#include "sphsolve/solute/walk_cells.h"

#include <math.h>
#include <stdbool.h>

#include "common/memory.h"
#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/flow_cells.h"
#include "sphsolve/solute/volumes.h"
#include "common/variants.h"

/* The surface at which walkers are reflected: the zero level of a distance that is given at the
 * corners of the cells and trilinear between them. */

#define ROUNDS 8 /* of shifting corners; each reduces the rest by a third to a half */
#define SUB 4    /* samples along each side of a cell */
#define SAMPLES (SUB * SUB * SUB)
#define SHIFT_MAX 0.5 /* largest total shift of a corner's distance, spacings */
#define AREA_MIN 1    /* surface around a corner, in faces, below which it is shifted less */

/* Interpolates from the four centres along each axis (third order; the mean of the eight centres
 * around would shift a curved wall by 1/8 of its curvature), limited to the range of these
 * eight. */
static float interpolated(const struct solute_flow *f, int i, int j, int k) {
  static const double weight[4] = {-1.0 / 16, 9.0 / 16, 9.0 / 16, -1.0 / 16};
  const int corner[3] = {i, j, k};
  double sum = 0, least = INFINITY, most = -INFINITY;
  size_t at[3][4], step = 1;
  for (int a = 0; a < 3; step *= (size_t)f->n[a++])
    for (int t = 0; t < 4; t++)
      at[a][t] = step * (size_t)((corner[a] + t - 2 + 2 * f->n[a]) % f->n[a]);
  for (int c = 0; c < 64; c++) {
    const int x = c & 3, y = c >> 2 & 3, z = c >> 4;
    const double d = (double)f->distance[at[0][x] + at[1][y] + at[2][z]];
    sum += weight[x] * weight[y] * weight[z] * d;
    if ((x == 1 || x == 2) && (y == 1 || y == 2) && (z == 1 || z == 2))
      least = fmin(least, d), most = fmax(most, d);
  }
  return (float)fmin(fmax(sum, least), most);
}

/* Weight of each corner at each sample. */
struct weights {
  float of[8][SAMPLES];
};

static void set_weights(struct weights *weights) {
  for (int s = 0; s < SAMPLES; s++) {
    const int at[3] = {s % SUB, s / SUB % SUB, s / SUB / SUB};
    const float x[3] = {((float)at[0] + 0.5f) / SUB, ((float)at[1] + 0.5f) / SUB,
                        ((float)at[2] + 0.5f) / SUB};
    for (int c = 0; c < 8; c++)
      weights->of[c][s] =
          (c & 1 ? x[0] : 1 - x[0]) * (c & 2 ? x[1] : 1 - x[1]) * (c & 4 ? x[2] : 1 - x[2]);
  }
}

/* Fraction of a cell in which the distance interpolated from its corners is positive, and its
 * derivative with respect to that distance, 1/m: the surface per volume. */
TARGETS static float share_open(const struct weights *weights, const float corner[8], float width,
                                float *area) {
  float part[SAMPLES], partly[SAMPLES];
  for (int s = 0; s < SAMPLES; s++) part[s] = 0.5f * width;
  for (int c = 0; c < 8; c++)
    for (int s = 0; s < SAMPLES; s++) part[s] += corner[c] * weights->of[c][s];
  for (int s = 0; s < SAMPLES; s++) {
    const float share = part[s] / width;
    partly[s] = share > 0 && share < 1 ? 1.0f : 0.0f;
    part[s] = share < 0 ? 0 : share > 1 ? 1 : share;
  }
  for (int half = SAMPLES / 2; half > 0; half /= 2)
    for (int s = 0; s < half; s++) part[s] += part[s + half], partly[s] += partly[s + half];
  *area = partly[0] / (SAMPLES * width);
  return part[0] / SAMPLES;
}

/* Difference of the flow's fluid fraction to that of each cell, and its surface; 0 where there is
 * no wall. */
static void compare(const struct solute_flow *f, const struct weights *weights,
                    const float *corners, float width, float *deficit, float *area) {
#pragma omp parallel for schedule(static)
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const size_t at = solute_flow_at(f, i, j, k);
        float corner[8];
        int open = 0;
        for (int c = 0; c < 8; c++) {
          corner[c] = corners[solute_flow_at(f, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2))];
          open += corner[c] > 0;
        }
        const float own = f->volume[at];
        deficit[at] = area[at] = 0;
        if ((own <= 0 || own >= 1) && (open == 0 || open == 8)) continue;
        deficit[at] = own - share_open(weights, corner, width, &area[at]);
      }
}

/* Computes signed distances at the low corner of each cell of the flow, m, [count]. They are
 * interpolated from those at the centres and then shifted, by at most half a spacing, until the
 * cells around each corner together have the pore volume that they have in the flow: between two
 * walls the distance has a ridge, which interpolation cuts off. This would close throats and, where
 * cells are as large as the throats, remove a sixth of the pores. */
static enum status walk_surface_find(const struct solute_flow *f, float *corners) {
  enum status status = STATUS_OK;
  float *deficit = NULL, *area = NULL, *first = NULL;
  const double across = f->dimensions == 2 ? sqrt(f->spacing[0] * f->spacing[2]) : f->spacing[1];
  const float spacing = (float)cbrt(f->spacing[0] * across * f->spacing[2]);
  const float shift_max = (float)SHIFT_MAX * spacing;
  TRY(memory_allocate(&deficit, f->count, sizeof *deficit, "pores at the surface of walkers"));
  TRY(memory_allocate(&area, f->count, sizeof *area, "surface of walkers"));
  TRY(memory_allocate(&first, f->count, sizeof *first, "distances of corners"));
#pragma omp parallel for schedule(static)
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const size_t at = solute_flow_at(f, i, j, k);
        corners[at] = first[at] = interpolated(f, i, j, k);
      }
  struct weights weights;
  set_weights(&weights);
  for (int round = 0; round < ROUNDS; round++) {
    compare(f, &weights, corners, spacing / SUB, deficit, area);
#pragma omp parallel for schedule(static)
    for (int k = 0; k < f->n[2]; k++)
      for (int j = 0; j < f->n[1]; j++)
        for (int i = 0; i < f->n[0]; i++) {
          float total_deficit = 0, surface = 0;
          for (int c = 0; c < 8; c++) {
            const size_t cell = solute_flow_at(f, i - (c & 1), j - (c >> 1 & 1), k - (c >> 2));
            total_deficit += deficit[cell], surface += area[cell];
          }
          const size_t at = solute_flow_at(f, i, j, k);
          const float to = corners[at] + total_deficit / fmaxf(surface, AREA_MIN / spacing);
          corners[at] = fminf(fmaxf(to, first[at] - shift_max), first[at] + shift_max);
        }
  }
cleanup:
  MEMORY_FREE(&deficit, &area, &first);
  return status;
}

/* Variation of the flux along a face: subgrid information for walkers in addition to the means in
 * the finite volumes. */

/* Wall distance, m, at the middle of the face of axis `axis` that lies `by` cells from that of cell
 * x along `across`. */
static double distance_at(const struct solute_flow *f, const int x[3], int axis, int across,
                          int by) {
  int high[3] = {x[0], x[1], x[2]}, low[3];
  high[across] += by;
  for (int a = 0; a < 3; a++) low[a] = high[a];
  low[axis]--;
  return 0.5 * ((double)f->distance[solute_flow_at(f, high[0], high[1], high[2])] +
                (double)f->distance[solute_flow_at(f, low[0], low[1], low[2])]);
}

static size_t beside(const struct solute_flow *f, const int x[3], int across, int by) {
  int y[3] = {x[0], x[1], x[2]};
  y[across] += by;
  return solute_flow_at(f, y[0], y[1], y[2]);
}

/* Distance from the middle of the open face to a wall on the side `by`, cells; INFINITY: none
 * nearby. */
static double wall_at(const struct solute_flow *f, const int x[3], int axis, int across, int by) {
  if (f->aperture[axis][beside(f, x, across, by)] >= 1) return INFINITY;
  const double here = distance_at(f, x, axis, across, 0),
               there = distance_at(f, x, axis, across, by);
  const double wall = here > there ? here / (here - there) : INFINITY;
  return wall <= SLOPE_DISTANCE_MAX ? fmax(wall, 0.5) : INFINITY;
}

/* Slope of an uncut face: that in its middle of the parabola that has the mean of this face and, on
 * each side, the mean of the next face or, if a wall lies between, the value 0 at the wall. */
static double open_slope(const struct solute_flow *f, const int x[3], int axis, int across) {
  const float *q = f->velocity[axis];
  const double here = (double)q[beside(f, x, across, 0)], low = (double)q[beside(f, x, across, -1)],
               high = (double)q[beside(f, x, across, 1)];
  const double to_low = wall_at(f, x, axis, across, -1), to_high = wall_at(f, x, axis, across, 1);
  if (isinf(to_low) && isinf(to_high)) return 0.5 * (high - low);
  if (!isinf(to_low) && !isinf(to_high)) /* c (to_low + t) (to_high - t) */
    return here * (to_high - to_low) / (to_low * to_high - 1.0 / 12);
  const double w = fmin(to_low, to_high), square = w * w - 1.0 / 12;
  const double slope =
      (here * (1 - square) + (isinf(to_low) ? low : high) * square) / (w * (w + 1) - 1.0 / 12);
  return isinf(to_low) ? -slope : slope;
}

/* Slope of a face cut by the wall. The flux is linear over the whole face, with the given mean, and
 * along the normal of the wall so steep that the part in grain passes no net flux and the open part
 * all of it. The flux is 0 at the centroid of the part in grain, which lies beyond the wall; near
 * the wall walkers therefore have a little too much velocity, and too little in the middle. */
static double cut_slope(const struct solute_flow *f, const int x[3], int axis, int across) {
  const size_t at = solute_flow_at(f, x[0], x[1], x[2]);
  const double q = (double)f->velocity[axis][at], d = distance_at(f, x, axis, across, 0);
  double m[2], area, moment;
  for (int t = 0; t < 2; t++) {
    const int along = (axis + 1 + t) % 3;
    m[t] = 0.5 * (distance_at(f, x, axis, along, 1) - distance_at(f, x, axis, along, -1));
  }
  const double own = m[(across - axis + 3) % 3 - 1], rise = fabs(m[0]) + fabs(m[1]);
  if (rise < RISE_MIN * f->spacing[across]) return 0;
  solute_face_open(d, m[0], m[1], &area, &moment);
  if (area > FRACTION_MIN && area < 1 - FRACTION_MIN && moment > area * d)
    return own * q * (1 - area) / (moment - area * d);
  return own * 2 * q / (rise * fmax((double)f->aperture[axis][at], FRACTION_MIN));
}

/* Change of the flux (m/s) over one cell along `across`, for the face at the low side of cell x
 * along `axis`; 0 if the face is closed. */
static float walk_slope(const struct solute_flow *f, const int x[3], int axis, int across) {
  const size_t at = solute_flow_at(f, x[0], x[1], x[2]);
  const float open = f->aperture[axis][at];
  if (!(open > 0)) return 0;
  if (open < 1) return (float)cut_slope(f, x, axis, across);
  const float slope = (float)open_slope(f, x, axis, across);
  if (f->aperture[axis][beside(f, x, across, -1)] >= 1 &&
      f->aperture[axis][beside(f, x, across, 1)] >= 1)
    return slope;
  /* Limited such that the flux is at least 0 at the edges: there is no backflow at walls. */
  const float most = 2 * fabsf(f->velocity[axis][at]);
  return fminf(fmaxf(slope, -most), most);
}

#define INTEGER_MAX 32000 /* largest slope or distance in its unit, to fit 16 bits */

static size_t at(const int n[3], const int x[3]) {
  return ((size_t)x[2] * (size_t)n[1] + (size_t)x[1]) * (size_t)n[0] + (size_t)x[0];
}

/* Index of the cell at (i, j, k), -2 .. 2 each, from x, with periodic wrapping. */
static inline size_t around(const int n[3], const int x[3], int i, int j, int k) {
  const int step[3] = {i, j, k};
  int y[3];
  for (int a = 0; a < 3; a++) {
    y[a] = x[a] + step[a];
    if (y[a] < 0 || y[a] >= n[a]) y[a] = (y[a] % n[a] + n[a]) % n[a];
  }
  return at(n, y);
}

/* Factor from m/s to cells along the axis per time unit. */
static float unit_along(const struct solute_flow *f, int axis) {
  return (float)(f->spacing[0] / (f->spacing[axis] * (f->speed > 0 ? f->speed : 1)));
}

/* Computes the distances of the low corners of all cells in units of `unit` m, limited to 16
 * bits. */
static enum status find_corners(const struct solute_flow *f, double unit, int16_t *corners) {
  enum status status = STATUS_OK;
  float *distance = NULL;
  TRY(memory_allocate(&distance, f->count, sizeof *distance, "distances of corners"));
  TRY(walk_surface_find(f, distance));
  for (size_t c = 0; c < f->count; c++)
    corners[c] = (int16_t)lrint(fmin(fmax((double)distance[c] / unit, -INTEGER_MAX), INTEGER_MAX));
cleanup:
  memory_free(&distance);
  return status;
}

static int16_t corner_of(const struct solute_flow *f, const int16_t *corners, const int x[3],
                         int corner) {
  return corners[around(f->n, x, corner & 1, corner >> 1 & 1, corner >> 2)];
}

static float steepest(const struct solute_flow *f) {
  float most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++)
        for (int a = 0; a < 3; a++)
          for (int t = 1; t < 3; t++)
            most = fmaxf(most, unit_along(f, a) *
                                   fabsf(walk_slope(f, (int[3]){i, j, k}, a, (a + t) % 3)));
  return most;
}

static void make_velocity(const struct solute_flow *f, const int x[3], float slope_unit,
                          struct walk_cell *cell) {
  for (int a = 0; a < 3; a++)
    for (int side = 0; side < 2; side++) {
      int y[3] = {x[0], x[1], x[2]};
      const float unit = unit_along(f, a);
      y[a] = (y[a] + side) % f->n[a];
      cell->face[side][a] = unit * f->velocity[a][at(f->n, y)];
      for (int t = 0; t < 2 && slope_unit > 0; t++)
        cell->slope[2 * side + t][a] =
            (int16_t)lrintf(unit * walk_slope(f, y, a, (a + 1 + t) % 3) / slope_unit);
    }
}

/* Whether walkers may enter a cell: it contains water, or one of its corners lies in the pore and
 * it adjoins a cell with water. The surface of the walkers and the cuts of the flow differ
 * slightly. */
static bool is_used(const struct solute_flow *f, const int16_t *corners, const int x[3]) {
  if (f->volume[at(f->n, x)] > 0) return true;
  bool corner = false, near = false;
  for (int c = 0; c < 8 && !corner; c++) corner = corner_of(f, corners, x, c) > 0;
  for (int c = 0; c < 27 && corner && !near; c++)
    near = f->volume[around(f->n, x, c % 3 - 1, c / 3 % 3 - 1, c / 9 - 1)] > 0;
  return near;
}

/* The cell of a bit in a brick; false: outside the box. */
static bool cell_of(const struct walk_cells *cells, size_t brick, int bit, int x[3]) {
  size_t block = brick / 64;
  for (int a = 0; a < 3; a++) {
    x[a] = 16 * (int)(block % (size_t)cells->blocks[a]) + 4 * ((int)(brick >> 2 * a) & 3) +
           (bit >> 2 * a & 3);
    block /= (size_t)cells->blocks[a];
  }
  return x[0] < cells->n[0] && x[1] < cells->n[1] && x[2] < cells->n[2];
}

/* Marks the open and the cut cells, and numbers the open ones. */
static void fill_bricks(const struct solute_flow *f, const int16_t *corners,
                        struct walk_cells *cells) {
#pragma omp parallel for schedule(static)
  for (size_t b = 0; b < cells->bricks; b++)
    for (int bit = 0; bit < 64; bit++) {
      int x[3];
      if (!cell_of(cells, b, bit, x) || !is_used(f, corners, x)) continue;
      struct walk_brick *brick = &cells->brick[b];
      brick->open |= (uint64_t)1 << bit;
      bool cut = false;
      for (int c = 0; c < 8; c++) cut = cut || corner_of(f, corners, x, c) <= 0;
      if (cut) brick->cut |= (uint64_t)1 << bit;
    }
  for (size_t b = 0; b < cells->bricks; b++) {
    cells->brick[b].first = (uint32_t)cells->count;
    cells->count += (size_t)__builtin_popcountll(cells->brick[b].open);
  }
}

static bool near_wall(const struct walk_cells *cells, const int x[3]) {
  const int *n = cells->n;
  for (int k = x[2] - 1; k <= x[2] + 1; k++)
    for (int j = x[1] - 1; j <= x[1] + 1; j++)
      for (int i = x[0] - 1; i <= x[0] + 1; i++) {
        const walk_place y = {(i + n[0]) % n[0], (j + n[1]) % n[1], (k + n[2]) % n[2], 0};
        const uint32_t address = walk_address(cells, y);
        const struct walk_brick *brick = &cells->brick[address / 64];
        if (!((brick->open & ~brick->cut) >> address % 64 & 1)) return true;
      }
  return false;
}

static void fill_cells(const struct solute_flow *f, const int16_t *corners,
                       struct walk_cells *cells) {
#pragma omp parallel for schedule(static)
  for (size_t b = 0; b < cells->bricks; b++) {
    struct walk_brick *brick = &cells->brick[b];
    size_t number = brick->first;
    for (int bit = 0; bit < 64; bit++) {
      int x[3];
      if (!(brick->open >> bit & 1) || !cell_of(cells, b, bit, x)) continue;
      struct walk_cell *cell = &cells->cell[number];
      cells->place[number++] = (int32_t)at(f->n, x);
      make_velocity(f, x, cells->slope_unit, cell);
      for (int c = 0; c < 8; c++) cell->corner[c] = corner_of(f, corners, x, c);
      if (near_wall(cells, x)) brick->near |= (uint64_t)1 << bit;
    }
  }
}

enum status walk_cells_make(const struct solute_flow *f, struct walk_cells *cells) {
  enum status status = STATUS_OK;
  int16_t *corners = NULL;
  double diagonal = 0, padded = 4096;
  *cells = (struct walk_cells){.dimensions = f->dimensions, .bricks = 64};
  for (int a = 0; a < 3; a++) {
    cells->n[a] = f->n[a], cells->spacing[a] = f->spacing[a];
    cells->stretch[a] = (float)(f->spacing[0] / f->spacing[a]);
    cells->blocks[a] = (f->n[a] + 15) / 16;
    cells->bricks *= (size_t)cells->blocks[a];
    padded *= cells->blocks[a];
    diagonal = hypot(diagonal, f->spacing[a]);
  }
  if (f->dimensions == 2) cells->stretch[1] = 1; /* nothing varies along y */
  if (padded > INT32_MAX)
    return FAIL(STATUS_INPUT, "a walk counts at most %d cells, not %.0f", INT32_MAX, padded);
  /* Largest distance stored: two diagonals of a cell, beyond which no wall matters. */
  const double unit = 2 * diagonal / INTEGER_MAX;
  cells->distance_unit = (float)(unit / f->spacing[0]);
  cells->slope_unit = steepest(f) / INTEGER_MAX;
  TRY(memory_allocate(&corners, f->count, sizeof *corners, "distances of corners"));
  TRY(memory_allocate(&cells->brick, cells->bricks, sizeof *cells->brick, "bricks of cells"));
  TRY(find_corners(f, unit, corners));
  fill_bricks(f, corners, cells);
  for (size_t c = 0; c < f->count; c++) cells->volume += (double)f->volume[c];
  TRY(memory_allocate(&cells->cell, cells->count, sizeof *cells->cell, "cells of the walk"));
  TRY(memory_allocate(&cells->place, cells->count, sizeof(int32_t), "places of cells"));
  fill_cells(f, corners, cells);
cleanup:
  memory_free(&corners);
  if (status != STATUS_OK) walk_cells_free(cells);
  return status;
}

void walk_cells_free(struct walk_cells *cells) {
  MEMORY_FREE(&cells->cell, &cells->brick, &cells->place);
  *cells = (struct walk_cells){0};
}
