#include "ct2model/scanner/grain_depth.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/scanner/gaussian.h"

/* Voxels that depths are smoothed over. Distances between voxels take few values, and a flood must
 * settle which of two equal voxels is the deeper one: by the order of the scan, if by nothing else,
 * and then parts depend on how the scan lies. Smoothed, hardly any two are equal. */
static const double SMOOTHED = 1.0;
static const float FAR_AWAY = 1e12F;

/* Along the first axis, where each voxel is 0 or FAR_AWAY: how far the last 0 is on either side. */
static void row_distances(float *row, size_t n, float step) {
  const float square = step * step;
  float far = FAR_AWAY;
  for (size_t x = 0; x < n; x++) {
    far = row[x] > 0.0F ? far + 1.0F : 0.0F;
    row[x] = far;
  }
  for (size_t x = n; x-- > 0;) {
    far = row[x] > 0.0F ? far + 1.0F : 0.0F;
    const float least = far < row[x] ? far : row[x];
    row[x] = least < FAR_AWAY ? least * least * square : FAR_AWAY;
  }
}

/* Lines beside each other are taken together. */
enum { TOGETHER = 16 };

/* At voxel `at` of the lines: the least of `in` over all voxels, each with the square of its
 * distance, nearest first until none can be less; voxels GRAIN_DEEPEST away are all one. */
TARGETS static void find_least(const float *restrict in, size_t at, size_t n, float step,
                               float least[restrict TOGETHER]) {
  const float square = step * step;
  for (size_t l = 0; l < TOGETHER; l++) least[l] = in[at * TOGETHER + l];
  for (size_t k = 1; k < n && (float)(k - 1) * step <= (float)GRAIN_DEEPEST; k++) {
    const float far = (float)k * (float)k * square;
    const float *restrict last = in + (at >= k ? at - k : at) * TOGETHER;
    const float *restrict next = in + (at + k < n ? at + k : at) * TOGETHER;
    int more = 0;
#pragma omp simd reduction(| : more)
    for (size_t l = 0; l < TOGETHER; l++) {
      const float nearer = last[l] < next[l] ? last[l] : next[l], its = nearer + far;
      more |= least[l] > far;
      least[l] = its < least[l] ? its : least[l];
    }
    if (more == 0) return;
  }
}

/* Along the second or third axis; `lines` has room for TOGETHER of the longest for each thread. */
static void axis_distances(float *field, const size_t size[3], int axis, float stretch,
                           float *lines, size_t longest) {
  const size_t nx = size[0], along = axis == 1 ? nx : nx * size[1], n = size[axis];
  const size_t groups = (nx + TOGETHER - 1) / TOGETHER, others = axis == 1 ? size[2] : size[1];
#pragma omp parallel for schedule(static)
  for (size_t group = 0; group < groups * others; group++) {
    float *own = lines + (size_t)omp_get_thread_num() * TOGETHER * longest, least[TOGETHER];
    const size_t x = group % groups * TOGETHER,
                 count = nx - x < TOGETHER ? nx - x : TOGETHER; // NOLINT: has a group
    float *to = field + group / groups * (axis == 1 ? nx * size[1] : nx) + x;
    for (size_t i = 0; i < n; i++)
      for (size_t l = 0; l < TOGETHER; l++)
        own[i * TOGETHER + l] = l < count ? to[i * along + l] : 0.0F;
    for (size_t i = 0; i < n; i++) {
      find_least(own, i, n, stretch, least);
      memcpy(to + i * along, least, count * sizeof *least);
    }
  }
}

/* field: 0 where distances are from, FAR_AWAY elsewhere; then their squares (each axis adds its
 * part, Felzenszwalb and Huttenlocher 2012), those beyond GRAIN_DEEPEST too large. */
static enum status squared_distances(float *field, const size_t size[3], const double stretch[3]) {
  enum status status = STATUS_OK;
  const size_t threads = (size_t)omp_get_max_threads(),
               longest = size[1] > size[2] ? size[1] : size[2];
  float *lines = NULL;
  TRY(memory_allocate(&lines, threads * TOGETHER, longest * sizeof *lines, "distances in grains"));
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < size[1] * size[2]; row++)
    row_distances(field + row * size[0], size[0], (float)stretch[0]);
  for (int d = 1; d < 3; d++) axis_distances(field, size, d, (float)stretch[d], lines, longest);
cleanup:
  memory_free(&lines);
  return status;
}

enum status grain_depth_find(const float *share, const size_t size[3], const double stretch[3],
                             float *depth) {
  enum status status = STATUS_OK;
  const size_t n = size[0] * size[1] * size[2];
  const float deepest = GRAIN_DEEPEST;
  float *outside = NULL;
  double sigma[3];
  TRY(memory_allocate(&outside, n, sizeof *outside, "distances in grains"));
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < n; i++) {
    const bool grain = share[i] > 0.5F;
    depth[i] = grain ? FAR_AWAY : 0.0F;
    outside[i] = grain ? 0.0F : FAR_AWAY;
  }
  TRY(squared_distances(depth, size, stretch));
  TRY(squared_distances(outside, size, stretch));
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < n; i++) {
    const bool grain = share[i] > 0.5F;
    const float signed_depth = grain ? sqrtf(depth[i]) - 0.5F : 0.5F - sqrtf(outside[i]);
    const float most = signed_depth < deepest ? signed_depth : deepest;
    depth[i] = most > -deepest ? most : -deepest;
  }
  for (int d = 0; d < 3; d++) sigma[d] = SMOOTHED / stretch[d];
  gaussian_filter(depth, size, sigma, outside, depth);
cleanup:
  memory_free(&outside);
  return status;
}
