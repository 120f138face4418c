#include "ct2model/scanner/grain_depth.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/gaussian.h"

static const float FAR_AWAY = 1e12F;

/* Squared distances along the first axis to the nearest voxel that is 0; on entry each voxel is 0
 * or FAR_AWAY. */
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

/* Number of adjacent lines that are processed together. */
enum { LINES = 16 };

/* The minimum over all voxels of the lines of `in` plus the squared distance to voxel `at`, nearest
 * first, until no farther voxel can give less. Voxels beyond GRAIN_DEEPEST do not matter. */
TARGETS static void find_least(const float *restrict in, size_t at, size_t n, float step,
                               float least[restrict LINES]) {
  const float square = step * step;
  for (size_t l = 0; l < LINES; l++) least[l] = in[at * LINES + l];
  for (size_t k = 1; k < n && (float)(k - 1) * step <= (float)GRAIN_DEEPEST; k++) {
    const float distance = (float)k * (float)k * square;
    const float *restrict last = in + (at >= k ? at - k : at) * LINES;
    const float *restrict next = in + (at + k < n ? at + k : at) * LINES;
    int more = 0;
#pragma omp simd reduction(| : more)
    for (size_t l = 0; l < LINES; l++) {
      const float nearer = last[l] < next[l] ? last[l] : next[l], candidate = nearer + distance;
      more |= least[l] > distance;
      least[l] = candidate < least[l] ? candidate : least[l];
    }
    if (more == 0) return;
  }
}

/* Adds the distances along the second or third axis. `lines` has room for LINES lines of the
 * longest axis for each thread. */
static void axis_distances(float *field, const size_t size[3], int axis, float stretch,
                           float *lines, size_t longest) {
  const size_t nx = size[0], along = axis == 1 ? nx : nx * size[1], n = size[axis];
  const size_t groups = (nx + LINES - 1) / LINES, others = axis == 1 ? size[2] : size[1];
#pragma omp parallel for schedule(static)
  for (size_t group = 0; group < groups * others; group++) {
    float *thread_lines = lines + (size_t)omp_get_thread_num() * LINES * longest, least[LINES];
    const size_t x = group % groups * LINES,
                 count = nx - x < LINES ? nx - x : LINES; // NOLINT: has a group
    float *to = field + group / groups * (axis == 1 ? nx * size[1] : nx) + x;
    for (size_t i = 0; i < n; i++)
      for (size_t l = 0; l < LINES; l++)
        thread_lines[i * LINES + l] = l < count ? to[i * along + l] : 0.0F;
    for (size_t i = 0; i < n; i++) {
      find_least(thread_lines, i, n, stretch, least);
      memcpy(to + i * along, least, count * sizeof *least);
    }
  }
}

/* field: 0 at the voxels from which distances are measured, FAR_AWAY elsewhere. It becomes the
 * squared distance, to which each axis adds its part (Felzenszwalb and Huttenlocher 2012).
 * Distances beyond GRAIN_DEEPEST come out too large. */
static enum status squared_distances(float *field, const size_t size[3], const double stretch[3]) {
  enum status status = STATUS_OK;
  const size_t threads = (size_t)omp_get_max_threads(),
               longest = size[1] > size[2] ? size[1] : size[2];
  float *lines = NULL;
  TRY(memory_allocate(&lines, threads * LINES, longest * sizeof *lines, "distances in grains"));
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
  for (int d = 0; d < 3; d++) sigma[d] = DEPTH_SMOOTHED / stretch[d];
  gaussian_filter(depth, size, sigma, outside, depth);
cleanup:
  memory_free(&outside);
  return status;
}
