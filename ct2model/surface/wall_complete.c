#include "ct2model/surface/wall_distance.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "common/memory.h"

/* Upwind solution of |grad d| = 1 from the smaller neighbour along each of three axes. */
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

static double smaller_distance(const float *distance, size_t a, size_t b) {
  const double one = fabs((double)distance[a]), other = fabs((double)distance[b]);
  return one < other ? one : other;
}

/* Updates a voxel from its neighbours; true if its distance decreases. */
static bool update_voxel(float *distance, const size_t size[3], const double spacing[3], size_t x,
                         size_t y, size_t z) {
  const size_t nx = size[0], ny = size[1], nz = size[2], row = (z * ny + y) * nx;
  double value[3] = {smaller_distance(distance, row + (x + 1) % nx, row + (x + nx - 1) % nx),
                     smaller_distance(distance, (z * ny + (y + 1) % ny) * nx + x,
                                      (z * ny + (y + ny - 1) % ny) * nx + x),
                     smaller_distance(distance, ((z + 1) % nz * ny + y) * nx + x,
                                      ((z + nz - 1) % nz * ny + y) * nx + x)};
  const float better = (float)eikonal(value, spacing);
  if (!(better < distance[row + x] * 0.999999f)) return false;
  distance[row + x] = better;
  return true;
}

/* The open voxels as bits, with whole words for each row, and those of them one of whose neighbours
 * has changed since their last update: no other can change (Bak, McLaughlin, Renzi 2010). */
enum { WORD = 64 };
struct open {
  size_t words;
  uint64_t *all, *due;
};

static void set_due(struct open *open, size_t row, size_t x) {
  const size_t w = row * open->words + x / WORD;
  open->due[w] |= open->all[w] & (uint64_t)1 << x % WORD;
}

static void neighbours_due(struct open *open, const size_t size[3], size_t x, size_t y, size_t z) {
  const size_t nx = size[0], ny = size[1], nz = size[2], row = z * ny + y;
  set_due(open, row, (x + 1) % nx);
  set_due(open, row, (x + nx - 1) % nx);
  set_due(open, z * ny + (y + 1) % ny, x);
  set_due(open, z * ny + (y + ny - 1) % ny, x);
  set_due(open, (z + 1) % nz * ny + y, x);
  set_due(open, (z + nz - 1) % nz * ny + y, x);
}

/* One pass over the open voxels in the direction given by the three bits of `corner`. True if a
 * distance changed. */
static bool sweep(float *distance, struct open *open, const size_t size[3], const double spacing[3],
                  unsigned corner) {
  const size_t ny = size[1], nz = size[2], words = open->words;
  bool changed = false;
  for (size_t k = 0; k < nz; k++) {
    const size_t z = (corner & 4) != 0 ? nz - 1 - k : k;
    for (size_t j = 0; j < ny; j++) {
      const size_t y = (corner & 2) != 0 ? ny - 1 - j : j;
      for (size_t i = 0; i < words; i++) {
        const size_t w = (corner & 1) != 0 ? words - 1 - i : i;
        uint64_t *due = &open->due[(z * ny + y) * words + w], ahead = ~(uint64_t)0;
        while ((*due & ahead) != 0) {
          const uint64_t left = *due & ahead;
          const int bit =
              (corner & 1) != 0 ? WORD - 1 - __builtin_clzll(left) : __builtin_ctzll(left);
          const uint64_t one = (uint64_t)1 << bit;
          const size_t x = w * WORD + (size_t)bit;
          ahead = (corner & 1) != 0 ? one - 1 : ~(one | (one - 1));
          *due &= ~one;
          if (!update_voxel(distance, size, spacing, x, y, z)) continue;
          neighbours_due(open, size, x, y, z);
          changed = true;
        }
      }
    }
  }
  return changed;
}

static enum status fill_open(float *distance, const size_t size[3], const double spacing[3]) {
  enum status status = STATUS_OK;
  const size_t nx = size[0], rows = size[1] * size[2], sites = nx * rows;
  struct open open = {.words = (nx + WORD - 1) / WORD};
  size_t count = 0;
  TRY(memory_allocate(&open.all, 2 * rows * open.words, sizeof *open.all,
                      "voxels far from a grain"));
  open.due = open.all + rows * open.words;
#pragma omp parallel for schedule(static) reduction(+ : count)
  for (size_t row = 0; row < rows; row++)
    for (size_t x = 0; x < nx; x++) {
      const bool is_open = !isfinite(distance[row * nx + x]);
      open.all[row * open.words + x / WORD] |= (uint64_t)is_open << x % WORD;
      count += is_open;
    }
  if (count == sites) { /* no surface at all: larger than any distance */
    double diagonal = 0.0;
    for (int d = 0; d < 3; d++) diagonal += pow((double)size[d] * spacing[d], 2.0);
    for (size_t i = 0; i < sites; i++) distance[i] = (float)sqrt(diagonal);
    count = 0;
  }
  memcpy(open.due, open.all, rows * open.words * sizeof *open.all);
  bool changed = count > 0;
  for (int round = 0; changed && round < 8; round++) {
    changed = false;
    for (unsigned corner = 0; corner < 8; corner++)
      changed |= sweep(distance, &open, size, spacing, corner);
  }
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < sites; i++) { /* voxels that no sweep has reached */
    if (!isfinite(distance[i])) distance[i] = (float)((double)size[0] * spacing[0]);
  }
cleanup:
  memory_free(&open.all);
  return status;
}

enum status wall_complete(float *distance, const unsigned char *solid, const size_t size[3],
                          const double spacing[3], size_t *disagree) {
  enum status status = STATUS_OK;
  const float floor_distance = (float)(0.01 * fmin(spacing[0], fmin(spacing[1], spacing[2])));
  size_t sites = size[0] * size[1] * size[2], count = 0;
  /* Signs: finite distances are compared with the model; the others get its sign below. */
#pragma omp parallel for schedule(static) reduction(+ : count)
  for (size_t i = 0; i < sites; i++) {
    if (!isfinite(distance[i])) continue;
    bool grain = distance[i] < 0.0f;
    if (grain == (solid[i] != 0) && fabsf(distance[i]) >= floor_distance) continue;
    count += grain != (solid[i] != 0);
    distance[i] = solid[i] != 0 ? -floor_distance : floor_distance;
  }
  TRY(fill_open(distance, size, spacing));
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < sites; i++) {
    if (solid[i] != 0) distance[i] = -fabsf(distance[i]);
  }
  *disagree = count;
cleanup:
  return status;
}
