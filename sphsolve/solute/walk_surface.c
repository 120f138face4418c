#include "sphsolve/solute/walk_surface.h"

#include <math.h>

#include "common/memory.h"
#include "sphsolve/solute/flow_internal.h"

#define ROUNDS 8     /* of moving corners; what is left shrinks in each by a third to a half */
#define SUB 4        /* samples along each side of a cell */
#define FARTHEST 0.5 /* spacings: how far a corner's distance may be moved in all */
#define LEAST_AREA 1 /* of a face: surface around a corner, below which it moves less */

/* From the four centres along each axis (third order; the mean of the eight around would move a
 * bent wall by 1/8 of its curvature), between those of the eight around. */
static float interpolated(const struct solute_flow *f, int i, int j, int k) {
  static const double weight[4] = {-0.0625, 0.5625, 0.5625, -0.0625};
  double sum = 0, least = INFINITY, most = -INFINITY;
  for (int c = 0; c < 64; c++) {
    const int x = c & 3, y = c >> 2 & 3, z = c >> 4;
    int at[3] = {i + x - 2, j + y - 2, k + z - 2};
    for (int a = 0; a < 3; a++) at[a] = (at[a] % f->n[a] + f->n[a]) % f->n[a];
    const double d = (double)f->distance[solute_flow_at(f, at[0], at[1], at[2])];
    sum += weight[x] * weight[y] * weight[z] * d;
    if ((x == 1 || x == 2) && (y == 1 || y == 2) && (z == 1 || z == 2))
      least = fmin(least, d), most = fmax(most, d);
  }
  return (float)fmin(fmax(sum, least), most);
}

/* Share of a cell in which the distance between its corners is positive, and how it grows with
 * them, 1/m: the surface over the volume. */
static float share_open(const float corner[8], float width, float *area) {
  float share = 0, partly = 0;
  for (int s = 0; s < SUB * SUB * SUB; s++) {
    const float x = ((float)(s % SUB) + 0.5f) / SUB, y = ((float)(s / SUB % SUB) + 0.5f) / SUB,
                z = ((float)(s / SUB / SUB) + 0.5f) / SUB;
    float edge[4];
    for (int e = 0; e < 4; e++) edge[e] = corner[2 * e] + x * (corner[2 * e + 1] - corner[2 * e]);
    const float low = edge[0] + y * (edge[1] - edge[0]), high = edge[2] + y * (edge[3] - edge[2]);
    const float part = 0.5f + (low + z * (high - low)) / width;
    share += part < 0 ? 0 : part > 1 ? 1 : part;
    partly += part > 0 && part < 1;
  }
  *area = partly / (SUB * SUB * SUB * width);
  return share / (SUB * SUB * SUB);
}

/* What each cell lacks of the flow's share, and its surface; 0 where no wall passes. */
static void compare(const struct solute_flow *f, const float *corners, float width, float *lacks,
                    float *area) {
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
        lacks[at] = area[at] = 0;
        if ((own <= 0 || own >= 1) && (open == 0 || open == 8)) continue;
        lacks[at] = own - share_open(corner, width, &area[at]);
      }
}

enum status walk_surface_find(const struct solute_flow *f, float *corners) {
  enum status status = STATUS_OK;
  float *lacks = NULL, *area = NULL, *first = NULL;
  const double across = f->dimensions == 2 ? sqrt(f->spacing[0] * f->spacing[2]) : f->spacing[1];
  const float spacing = (float)cbrt(f->spacing[0] * across * f->spacing[2]);
  const float most = (float)FARTHEST * spacing;
  TRY(memory_allocate(&lacks, f->count, sizeof *lacks, "pores at the surface of walkers"));
  TRY(memory_allocate(&area, f->count, sizeof *area, "surface of walkers"));
  TRY(memory_allocate(&first, f->count, sizeof *first, "distances of corners"));
#pragma omp parallel for schedule(static)
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const size_t at = solute_flow_at(f, i, j, k);
        corners[at] = first[at] = interpolated(f, i, j, k);
      }
  for (int round = 0; round < ROUNDS; round++) {
    compare(f, corners, spacing / SUB, lacks, area);
#pragma omp parallel for schedule(static)
    for (int k = 0; k < f->n[2]; k++)
      for (int j = 0; j < f->n[1]; j++)
        for (int i = 0; i < f->n[0]; i++) {
          float lack = 0, surface = 0;
          for (int c = 0; c < 8; c++) {
            const size_t cell = solute_flow_at(f, i - (c & 1), j - (c >> 1 & 1), k - (c >> 2));
            lack += lacks[cell], surface += area[cell];
          }
          const size_t at = solute_flow_at(f, i, j, k);
          const float to = corners[at] + lack / fmaxf(surface, LEAST_AREA / spacing);
          corners[at] = fminf(fmaxf(to, first[at] - most), first[at] + most);
        }
  }
cleanup:
  memory_free(&lacks);
  memory_free(&area);
  memory_free(&first);
  return status;
}
