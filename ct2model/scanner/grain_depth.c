#include "ct2model/scanner/grain_depth.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>

#include "common/memory.h"
#include "ct2model/scanner/gaussian.h"

/* Voxels that depths are smoothed over. Distances between voxels take few values, and a flood must
 * settle which of two equal voxels is the deeper one: by the order of the scan, if by nothing else,
 * and then parts depend on how the scan lies. Smoothed, hardly any two are equal. */
static const double SMOOTHED = 1.0;
static const float FAR_AWAY = 1e12F;

/* Squared distances along one line, given those across: the lower envelope of parabolas
 * (Felzenszwalb and Huttenlocher 2012). `place` and `from` hold the envelope, n of each. */
static void line_distances(const float *in, size_t n, float step, float *out, size_t *place,
                           float *from) {
  const float square = step * step;
  size_t last = 0;
  place[0] = 0;
  from[0] = -INFINITY;
  for (size_t q = 1; q < n; q++) {
    float meet = 0.0F;
    for (;; last--) {
      const size_t p = place[last];
      meet = ((in[q] - in[p]) / square + (float)(q * q) - (float)(p * p)) / (2.0F * (float)(q - p));
      if (meet > from[last] || last == 0) break;
    }
    place[++last] = q;
    from[last] = meet;
  }
  for (size_t q = 0, at = 0; q < n; q++) {
    while (at < last && from[at + 1] < (float)q) at++;
    const float d = (float)q - (float)place[at];
    out[q] = d * d * square + in[place[at]];
  }
}

/* Lines beside each other are taken together: they share what the cache holds of them. */
enum { TOGETHER = 16 };

/* What a thread needs for that. */
struct lines {
  size_t length, *place;
  float *in, *from, *out;
};

static void axis_distances(float *field, const size_t size[3], int axis, float stretch,
                           const struct lines *lines) {
  const size_t step[3] = {1, size[0], size[0] * size[1]}, along = step[axis], n = size[axis];
  const int e = axis == 0 ? 1 : 0, f = axis == 2 ? 1 : 2; /* the axes across */
  const size_t groups = (size[e] + TOGETHER - 1) / TOGETHER;
#pragma omp parallel for schedule(static)
  for (size_t group = 0; group < groups * size[f]; group++) {
    const struct lines *own = &lines[omp_get_thread_num()];
    const size_t first = group % groups * TOGETHER, left = size[e] - first; // NOLINT: has a group
    const size_t count = left < TOGETHER ? left : TOGETHER, length = own->length;
    float *at = field + first * step[e] + group / groups * step[f];
    for (size_t i = 0; i < n; i++)
      for (size_t l = 0; l < count; l++) own->in[l * length + i] = at[i * along + l * step[e]];
    for (size_t l = 0; l < count; l++)
      line_distances(own->in + l * length, n, stretch, own->out + l * length, own->place,
                     own->from);
    for (size_t i = 0; i < n; i++)
      for (size_t l = 0; l < count; l++) at[i * along + l * step[e]] = own->out[l * length + i];
  }
}

/* field: 0 where distances are from, FAR_AWAY elsewhere; then their squares. */
static enum status squared_distances(float *field, const size_t size[3], const double stretch[3]) {
  enum status status = STATUS_OK;
  const size_t threads = (size_t)omp_get_max_threads();
  size_t longest = 1;
  struct lines *lines = NULL;
  for (int d = 0; d < 3; d++) longest = size[d] > longest ? size[d] : longest;
  TRY(memory_allocate(&lines, threads, sizeof *lines, "distances in grains"));
  for (size_t t = 0; t < threads; t++) {
    lines[t].length = longest;
    TRY(memory_allocate(&lines[t].place, longest, sizeof(size_t), "distances in grains"));
    TRY(memory_allocate(&lines[t].in, (2 * TOGETHER + 1) * longest, sizeof(float),
                        "distances in grains"));
    lines[t].out = lines[t].in + TOGETHER * longest;
    lines[t].from = lines[t].out + TOGETHER * longest;
  }
  for (int d = 0; d < 3; d++) axis_distances(field, size, d, (float)stretch[d], lines);
cleanup:
  for (size_t t = 0; t < threads && lines != NULL; t++) {
    memory_free(&lines[t].place);
    memory_free(&lines[t].in);
  }
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
