#include "sphsolve/solute/walk_surface.h"

#include <math.h>

#include "common/memory.h"
#include "common/variants.h"
#include "sphsolve/solute/flow.h"

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

enum status walk_surface_find(const struct solute_flow *f, float *corners) {
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
