#include "ct2model/scanner/grains.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/gaussian.h"

/* ---- depth of voxels in their grain ---- */

/* Depths in grain and in pore are limited to this, in shortest voxel edges. */
enum { GRAIN_DEEPEST = 250 };
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

/* depth[z][y][x]: distance to the other phase, in shortest voxel edges (`stretch`: voxel edges over
 * the shortest), negative in pores, smoothed over a voxel. A voxel is grain where share[z][y][x] is
 * above 1/2. */
static enum status find_depth(const float *share, const size_t size[3], const double stretch[3],
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

/* ---- watershed ---- */

/* The watershed floods the grains from the deepest voxels: each voxel joins the part of its deepest
 * neighbour that was flooded before it. Which neighbour this is (its "way") depends on that voxel
 * alone, so that ways are found in parallel; they lead to the deepest voxel of a part. The order of
 * the flood matters only where parts meet, since parts of one grain are joined then. */

/* LEVELS_PER_VOXEL:
 * levels per voxel of depth; voxels of one level are flooded in the order of the scan. NOBODY:
 * number of the part of voxels that belong to none. */
enum { LEVELS_PER_VOXEL = 65536, NOBODY = 0 };
/* Neighbours: along axis d the previous one is way 2 d, the next one way 2 d + 1. DEEPEST: the
 * voxel is the deepest of a part. NONE: it belongs to no grain. */
enum { WAYS = 6, DEEPEST = 6, NONE = 7 };
#define NEVER UINT32_MAX /* level of voxels that the flood does not reach */

struct flood {
  size_t size[3], step[3];
  const float *depth; /* of each voxel, in voxels; negative in pores */
  uint8_t *way;       /* of voxels */
  uint32_t *part;     /* of each voxel: first its level, then its part, from 1 on */
  uint32_t *parent;   /* of each part; its own number where it is a root */
  float *peak;        /* largest depth of each part */
  size_t parts;
};

/* Level at which a voxel is flooded; 0 is the deepest. */
static uint32_t level_of(float depth) {
  const float most = depth < (float)GRAIN_DEEPEST ? depth : (float)GRAIN_DEEPEST;
  return depth > -PORE_RANGE ? (uint32_t)(((float)GRAIN_DEEPEST - most) * (float)LEVELS_PER_VOXEL)
                             : NEVER;
}

/* Whether a neighbour is flooded before a voxel of the given level. */
static bool is_earlier(uint32_t neighbour_level, int way, uint32_t level) {
  return way % 2 ? neighbour_level < level : neighbour_level <= level;
}

static bool has_neighbour(const struct flood *flood, const size_t at[3], int way) {
  const int d = way / 2;
  return way % 2 ? at[d] + 1 < flood->size[d] : at[d] > 0;
}

static size_t neighbour_of(const struct flood *flood, size_t voxel, int way) {
  return way % 2 ? voxel + flood->step[way / 2] : voxel - flood->step[way / 2];
}

static void position_of(const struct flood *flood, size_t voxel, size_t at[3]) {
  at[0] = voxel % flood->size[0];
  at[1] = voxel / flood->size[0] % flood->size[1];
  at[2] = voxel / flood->step[2];
}

/* The way to the deepest neighbour that was flooded earlier, on request without those that are
 * known to belong to no grain. */
static uint8_t find_way(const struct flood *flood, size_t voxel, const size_t at[3],
                        bool skip_nobodys) {
  const uint32_t level = flood->part[voxel];
  float highest = -INFINITY;
  uint8_t best = flood->depth[voxel] > 0.0F ? DEEPEST : NONE;
  if (level == NEVER) return NONE;
  for (int way = 0; way < WAYS; way++) {
    if (!has_neighbour(flood, at, way)) continue;
    const size_t other = neighbour_of(flood, voxel, way);
    if (!is_earlier(flood->part[other], way, level)) continue;
    if (skip_nobodys && flood->way[other] == NONE) continue;
    if (!(flood->depth[other] > highest)) continue;
    highest = flood->depth[other];
    best = (uint8_t)way;
  }
  return best;
}

static size_t find_ways(struct flood *flood) {
  const size_t nx = flood->size[0], rows = flood->size[1] * flood->size[2];
  size_t lonely = 0;
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < nx * rows; i++) flood->part[i] = level_of(flood->depth[i]);
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : lonely)
  for (size_t row = 0; row < rows; row++)
    for (size_t x = 0; x < nx; x++) {
      const size_t at[3] = {x, row % flood->size[1], row / flood->size[1]}, i = row * nx + x;
      flood->way[i] = find_way(flood, i, at, false);
      lonely += flood->way[i] == NONE && flood->part[i] != NEVER;
    }
  return lonely;
}

/* A voxel of a pore without an earlier neighbour belongs to no grain, nor do those whose only
 * earlier neighbours are such voxels. There are few. */
static enum status drop_lonely(struct flood *flood, size_t lonely) {
  enum status status = STATUS_OK;
  const size_t n = flood->step[2] * flood->size[2];
  size_t *pending = NULL, count = 0, room = lonely;
  if (lonely == 0) return STATUS_OK;
  TRY(memory_allocate(&pending, room, sizeof *pending, "grains"));
  for (size_t i = 0; i < n; i++)
    if (flood->way[i] == NONE && flood->part[i] != NEVER) pending[count++] = i;
  while (count > 0) {
    const size_t voxel = pending[--count];
    size_t at[3], other_at[3];
    position_of(flood, voxel, at);
    for (int way = 0; way < WAYS; way++) {
      if (!has_neighbour(flood, at, way)) continue;
      const size_t other = neighbour_of(flood, voxel, way);
      if (flood->way[other] != (way ^ 1)) continue; /* its way does not lead here */
      position_of(flood, other, other_at);
      flood->way[other] = find_way(flood, other, other_at, true);
      if (flood->way[other] != NONE) continue;
      if (count == room) TRY(memory_resize(&pending, room *= 2, sizeof *pending, "grains"));
      pending[count++] = other;
    }
  }
cleanup:
  memory_free(&pending);
  return status;
}

/* Numbers the parts, and follows the way of each voxel to its part. */
static enum status follow_ways(struct flood *flood) {
  enum status status = STATUS_OK;
  const size_t nx = flood->size[0], rows = flood->size[1] * flood->size[2];
  for (size_t i = 0; i < nx * rows; i++) flood->parts += flood->way[i] == DEEPEST;
  TRY(memory_allocate(&flood->parent, flood->parts + 1, sizeof *flood->parent, "grains"));
  TRY(memory_allocate(&flood->peak, flood->parts + 1, sizeof *flood->peak, "grains"));
  for (size_t i = 0, part = 0; i < nx * rows; i++) {
    if (flood->way[i] != DEEPEST) continue;
    part++;
    flood->parent[part] = flood->part[i] = (uint32_t)part;
    flood->peak[part] = flood->depth[i];
  }
#pragma omp parallel for schedule(dynamic, 64)
  for (size_t row = 0; row < rows; row++)
    for (size_t i = row * nx; i < (row + 1) * nx; i++) {
      if (flood->way[i] == DEEPEST) continue;
      if (flood->way[i] == NONE) {
        flood->part[i] = NOBODY;
      } else if (flood->way[i] == 0) { /* the voxel before, of this row */
        flood->part[i] = flood->part[i - 1];
      } else {
        size_t to = i;
        while (flood->way[to] < WAYS) to = neighbour_of(flood, to, flood->way[to]);
        flood->part[i] = flood->part[to];
      }
    }
cleanup:
  return status;
}

/* A voxel at which parts may be joined. */
struct meeting {
  uint32_t level;
  size_t voxel;
};

static int compare_meetings(const void *a, const void *b) {
  const struct meeting *one = a, *other = b;
  if (one->level != other->level) return one->level < other->level ? -1 : 1;
  return one->voxel < other->voxel ? -1 : one->voxel > other->voxel;
}

/* Whether the voxel is deep enough to join its part with another one, by the depths of the single
 * parts; joined parts are at least as deep, so that no meeting is missed. */
static bool may_join(const struct flood *flood, size_t voxel, const size_t at[3]) {
  const uint32_t part = flood->part[voxel];
  const float depth = flood->depth[voxel];
  for (int way = 0; way < WAYS; way++) {
    if (!has_neighbour(flood, at, way)) continue;
    const uint32_t other = flood->part[neighbour_of(flood, voxel, way)];
    if (other != part && other != NOBODY &&
        !(depth < (float)MERGE_DEPTH * fminf(flood->peak[part], flood->peak[other])))
      return true;
  }
  return false;
}

/* Writes the meetings of a row to `out` if that is not NULL; returns their number. */
static size_t row_meetings(const struct flood *flood, size_t row, struct meeting *out) {
  const size_t nx = flood->size[0];
  size_t count = 0;
  for (size_t x = 0; x < nx; x++) {
    const size_t at[3] = {x, row % flood->size[1], row / flood->size[1]}, i = row * nx + x;
    if (!(flood->depth[i] > 0.0F) || !may_join(flood, i, at)) continue;
    if (out != NULL) out[count] = (struct meeting){level_of(flood->depth[i]), i};
    count++;
  }
  return count;
}

static uint32_t root_of(uint32_t *parent, uint32_t part) {
  while (parent[part] != part) part = parent[part] = parent[parent[part]];
  return part;
}

/* Joins the parts of one grain that meet at this voxel. */
static void join_at(struct flood *flood, const struct meeting *meeting) {
  const size_t voxel = meeting->voxel;
  size_t at[3];
  position_of(flood, voxel, at);
  for (int way = 0; way < WAYS; way++) {
    if (!has_neighbour(flood, at, way)) continue;
    const size_t other = neighbour_of(flood, voxel, way);
    if (flood->part[other] == NOBODY ||
        !is_earlier(level_of(flood->depth[other]), way, meeting->level))
      continue;
    const uint32_t a = root_of(flood->parent, flood->part[voxel]),
                   b = root_of(flood->parent, flood->part[other]);
    if (a == b || flood->depth[voxel] < (float)MERGE_DEPTH * fminf(flood->peak[a], flood->peak[b]))
      continue;
    const bool first = flood->peak[a] >= flood->peak[b];
    flood->parent[first ? b : a] = first ? a : b;
  }
}

static enum status join_parts(struct flood *flood) {
  enum status status = STATUS_OK;
  const size_t nx = flood->size[0], rows = flood->size[1] * flood->size[2];
  size_t *first = NULL;
  struct meeting *meetings = NULL;
  TRY(memory_allocate(&first, rows + 1, sizeof *first, "grains"));
#pragma omp parallel for schedule(dynamic, 64)
  for (size_t row = 0; row < rows; row++) first[row + 1] = row_meetings(flood, row, NULL);
  for (size_t row = 0; row < rows; row++) first[row + 1] += first[row];
  TRY(memory_allocate(&meetings, first[rows], sizeof *meetings, "grains"));
#pragma omp parallel for schedule(dynamic, 64)
  for (size_t row = 0; row < rows; row++) (void)row_meetings(flood, row, meetings + first[row]);
  if (first[rows] > 0) qsort(meetings, first[rows], sizeof *meetings, compare_meetings);
  for (size_t i = 0; i < first[rows]; i++) join_at(flood, &meetings[i]);
  for (uint32_t part = 1; part <= flood->parts; part++)
    flood->parent[part] = root_of(flood->parent, part);
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < nx * rows; i++) flood->part[i] = flood->parent[flood->part[i]];
cleanup:
  MEMORY_FREE(&first, &meetings);
  return status;
}

static void mark_contacts(const struct flood *flood, uint8_t *contacts) {
  const size_t nx = flood->size[0], rows = flood->size[1] * flood->size[2];
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < rows; row++)
    for (size_t x = 0; x < nx; x++) {
      const size_t at[3] = {x, row % flood->size[1], row / flood->size[1]}, i = row * nx + x;
      const uint32_t part = flood->part[i];
      unsigned marks = 0;
      for (int way = 0; way < WAYS && part != NOBODY; way++) {
        if (!has_neighbour(flood, at, way)) continue;
        const uint32_t other = flood->part[neighbour_of(flood, i, way)];
        if (other != NOBODY && other != part)
          marks |= way % 2 ? GRAINS_NEXT(way / 2) : GRAINS_LAST(way / 2);
      }
      contacts[i] = (uint8_t)marks;
    }
}

enum status grains_find(const float *share, const size_t size[3], const double stretch[3],
                        uint8_t *contacts) {
  enum status status = STATUS_OK;
  struct flood flood = {.size = {size[0], size[1], size[2]},
                        .step = {1, size[0], size[0] * size[1]},
                        .way = contacts}; /* written only when the ways are no longer needed */
  const size_t n = flood.step[2] * size[2];
  float *depth = NULL;
  TRY(memory_allocate(&depth, n, sizeof *depth, "grains"));
  TRY(memory_allocate(&flood.part, n, sizeof *flood.part, "grains"));
  TRY(find_depth(share, size, stretch, depth));
  flood.depth = depth;
  TRY(drop_lonely(&flood, find_ways(&flood)));
  TRY(follow_ways(&flood));
  TRY(join_parts(&flood));
  mark_contacts(&flood, contacts);
cleanup:
  MEMORY_FREE(&depth, &flood.part, &flood.parent, &flood.peak);
  return status;
}
