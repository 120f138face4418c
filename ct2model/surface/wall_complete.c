#include "ct2model/surface/wall_distance.h"

#include <math.h>
#include <stdint.h>

#include "common/memory.h"

/* Upwind solution of |grad d| = 1 from the least neighbours along three axes. */
static double eikonal(double value[3], const double spacing[3]) {
  int order[3] = {0, 1, 2};
  for (int i = 0; i < 2; i++) {
    for (int j = 0; j < 2 - i; j++) {
      if (value[order[j]] > value[order[j + 1]]) {
        int swap = order[j];
        order[j] = order[j + 1];
        order[j + 1] = swap;
      }
    }
  }
  double a = 0.0, b = 0.0, c = -1.0, result = INFINITY;
  for (int i = 0; i < 3; i++) {
    double v = value[order[i]], w = 1.0 / (spacing[order[i]] * spacing[order[i]]);
    if (!(v < result)) break;
    a += w;
    b -= 2.0 * v * w;
    c += v * v * w;
    double square = b * b - 4.0 * a * c;
    if (square < 0.0) break;
    result = (-b + sqrt(square)) / (2.0 * a);
  }
  return result;
}

static double least(const float *distance, size_t a, size_t b) {
  return fmin(fabs((double)distance[a]), fabs((double)distance[b]));
}

/* One pass over the open voxels in the direction of the three bits of `corner`; `open` is a bit
 * set. True if something changed. */
static int sweep(float *distance, const unsigned char *open, const size_t size[3],
                 const double spacing[3], unsigned corner) {
  int changed = 0;
  size_t nx = size[0], ny = size[1], nz = size[2];
  for (size_t k = 0; k < nz; k++) {
    size_t z = (corner & 4) != 0 ? nz - 1 - k : k;
    for (size_t j = 0; j < ny; j++) {
      size_t y = (corner & 2) != 0 ? ny - 1 - j : j, row = (z * ny + y) * nx;
      for (size_t i = 0; i < nx; i++) {
        size_t x = (corner & 1) != 0 ? nx - 1 - i : i;
        if ((open[(row + x) / 8] >> (row + x) % 8 & 1) == 0) continue;
        double value[3] = {least(distance, row + (x + 1) % nx, row + (x + nx - 1) % nx),
                           least(distance, (z * ny + (y + 1) % ny) * nx + x,
                                 (z * ny + (y + ny - 1) % ny) * nx + x),
                           least(distance, ((z + 1) % nz * ny + y) * nx + x,
                                 ((z + nz - 1) % nz * ny + y) * nx + x)};
        float better = (float)eikonal(value, spacing);
        if (better < distance[row + x] * 0.999999f) {
          distance[row + x] = better;
          changed = 1;
        }
      }
    }
  }
  return changed;
}

static enum status fill_open(float *distance, const size_t size[3], const double spacing[3]) {
  enum status status = STATUS_OK;
  size_t sites = size[0] * size[1] * size[2], count = 0;
  unsigned char *open = NULL;
  TRY(memory_allocate(&open, (sites + 7) / 8, 1, "voxels far from a grain"));
  for (size_t i = 0; i < sites; i++) {
    if (isfinite(distance[i])) continue;
    open[i / 8] |= (unsigned char)(1u << i % 8);
    count++;
  }
  if (count == sites) { /* no surface at all: farther than anything */
    double diagonal = 0.0;
    for (int d = 0; d < 3; d++) diagonal += pow((double)size[d] * spacing[d], 2.0);
    for (size_t i = 0; i < sites; i++) distance[i] = (float)sqrt(diagonal);
    count = 0;
  }
  for (int round = 0, changed = count > 0; changed && round < 8; round++) {
    changed = 0;
    for (unsigned corner = 0; corner < 8; corner++)
      changed |= sweep(distance, open, size, spacing, corner);
  }
  for (size_t i = 0; i < sites; i++) { /* pockets no sweep has reached */
    if (!isfinite(distance[i])) distance[i] = (float)((double)size[0] * spacing[0]);
  }
cleanup:
  memory_free(&open);
  return status;
}

enum status wall_complete(float *distance, const unsigned char *solid, const size_t size[3],
                          const double spacing[3], size_t *disagree) {
  enum status status = STATUS_OK;
  const float floor_distance = (float)(0.01 * fmin(spacing[0], fmin(spacing[1], spacing[2])));
  size_t sites = size[0] * size[1] * size[2], count = 0;
  /* Signs first: far voxels take that of the model, near ones are compared with it. */
  for (size_t i = 0; i < sites; i++) {
    if (!isfinite(distance[i])) continue;
    bool grain = distance[i] < 0.0f;
    if (grain == (solid[i] != 0) && fabsf(distance[i]) >= floor_distance) continue;
    count += grain != (solid[i] != 0);
    distance[i] = solid[i] != 0 ? -floor_distance : floor_distance;
  }
  TRY(fill_open(distance, size, spacing));
  for (size_t i = 0; i < sites; i++) {
    if (solid[i] != 0) distance[i] = -fabsf(distance[i]);
  }
  *disagree = count;
cleanup:
  return status;
}
