#include "ct2model/scanner/grains.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/scanner/gaussian.h"

/* Two parts of a grain meet where it is nearly as thick as they are, two grains at a neck. */
static const float MERGE = 0.7F;
/* Voxels: pores further from grains are nobody's; deeper than that all depths are alike. STEPS a
 * voxel of depth: levels are of 24 bits, sorted by half of them at a time. */
enum { BESIDE = 6, DEEPEST = 250, STEPS = 65536, HALF = 12, DIGITS = 1 << HALF, NOBODY = 0 };
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

/* field: 0 where distances are from, FAR_AWAY elsewhere; then their squares. */
static enum status squared_distances(float *field, const size_t size[3], const double stretch[3]) {
  enum status status = STATUS_OK;
  const size_t step[3] = {1, size[0], size[0] * size[1]}, n = step[2] * size[2];
  size_t longest = 0, *place = NULL;
  float *line = NULL;
  for (int d = 0; d < 3; d++) longest = size[d] > longest ? size[d] : longest;
  TRY(memory_allocate(&line, 3 * longest, sizeof *line, "distances in grains"));
  TRY(memory_allocate(&place, longest, sizeof *place, "distances in grains"));
  for (int d = 0; d < 3; d++) {
    const int e = d == 0 ? 1 : 0, f = d == 2 ? 1 : 2;
    for (size_t l = 0; l < n / size[d]; l++) {
      float *at = field + l % size[e] * step[e] + l / size[e] * step[f];
      for (size_t i = 0; i < size[d]; i++) line[i] = at[i * step[d]];
      line_distances(line, size[d], (float)stretch[d], line + longest, place, line + 2 * longest);
      for (size_t i = 0; i < size[d]; i++) at[i * step[d]] = line[longest + i];
    }
  }
cleanup:
  memory_free(&line);
  memory_free(&place);
  return status;
}

struct flood {
  size_t size[3], step[3];
  float *depth;            /* of voxels, voxels; below 0 in the pore */
  uint32_t *part, *parent; /* of voxels, from 1 on; of parts, themselves where they are roots */
  float *peak;             /* of parts: the largest depth */
  size_t parts;
};

static uint32_t root_of(uint32_t *parent, uint32_t part) {
  while (parent[part] != part) part = parent[part] = parent[parent[part]];
  return part;
}

static enum status add_part(struct flood *flood, size_t voxel) {
  enum status status = STATUS_OK;
  const size_t n = ++flood->parts;
  if ((n & (n - 1)) == 0) { /* room for twice as many */
    TRY(memory_resize(&flood->parent, 2 * n, sizeof *flood->parent, "grains"));
    TRY(memory_resize(&flood->peak, 2 * n, sizeof *flood->peak, "grains"));
  }
  flood->parent[n] = (uint32_t)n;
  flood->peak[n] = flood->depth[voxel];
  flood->part[voxel] = (uint32_t)n;
cleanup:
  return status;
}

/* The voxel goes to the deepest of its neighbours; parts that are one grain become one. */
static enum status flood_voxel(struct flood *flood, size_t voxel) {
  uint32_t near[6];
  size_t count = 0, best = 0;
  float highest = -INFINITY;
  for (int d = 0; d < 3; d++) {
    const size_t at = voxel / flood->step[d] % flood->size[d];
    for (int side = 0; side < 2; side++) {
      if (side ? at + 1 == flood->size[d] : at == 0) continue;
      const size_t other = side ? voxel + flood->step[d] : voxel - flood->step[d];
      if (flood->part[other] == NOBODY) continue;
      if (flood->depth[other] > highest) best = count;
      highest = fmaxf(highest, flood->depth[other]);
      near[count++] = root_of(flood->parent, flood->part[other]);
    }
  }
  if (count == 0) return flood->depth[voxel] > 0.0F ? add_part(flood, voxel) : STATUS_OK;
  flood->part[voxel] = near[best];
  for (size_t i = 0; i < count; i++) {
    const uint32_t a = root_of(flood->parent, near[best]), b = root_of(flood->parent, near[i]);
    if (a == b || flood->depth[voxel] < MERGE * fminf(flood->peak[a], flood->peak[b])) continue;
    const bool first = flood->peak[a] >= flood->peak[b];
    flood->parent[first ? b : a] = first ? a : b;
  }
  return STATUS_OK;
}

/* Signed depths of voxels, smoothed. */
static enum status find_depths(const float *share, const double stretch[3], struct flood *flood) {
  enum status status = STATUS_OK;
  const size_t n = flood->step[2] * flood->size[2];
  float *outside = NULL;
  double sigma[3];
  TRY(memory_allocate(&outside, n, sizeof *outside, "distances in grains"));
  for (size_t i = 0; i < n; i++) {
    flood->depth[i] = share[i] > 0.5F ? FAR_AWAY : 0.0F;
    outside[i] = share[i] > 0.5F ? 0.0F : FAR_AWAY;
  }
  TRY(squared_distances(flood->depth, flood->size, stretch));
  TRY(squared_distances(outside, flood->size, stretch));
  for (size_t i = 0; i < n; i++) {
    const bool grain = share[i] > 0.5F;
    flood->depth[i] = fmaxf(
        fminf(grain ? sqrtf(flood->depth[i]) - 0.5F : 0.5F - sqrtf(outside[i]), DEEPEST), -DEEPEST);
  }
  for (int d = 0; d < 3; d++) sigma[d] = SMOOTHED / stretch[d];
  gaussian_filter(flood->depth, flood->size, sigma, outside, flood->depth);
cleanup:
  memory_free(&outside);
  return status;
}

/* 0 the deepest. */
static uint32_t level_of(float depth) {
  return (uint32_t)((DEEPEST - fminf(depth, DEEPEST)) * STEPS);
}

/* Voxels sorted by half the bits of their level, those of one in the order of `in` (radix sort). */
static void sort_half(const float *depth, const uint32_t *in, size_t count, int shift,
                      uint32_t *out) {
  size_t start[DIGITS + 1] = {0};
  for (size_t i = 0; i < count; i++) start[(level_of(depth[in[i]]) >> shift) % DIGITS + 1]++;
  for (size_t l = 1; l <= DIGITS; l++) start[l] += start[l - 1];
  for (size_t i = 0; i < count; i++)
    out[start[(level_of(depth[in[i]]) >> shift) % DIGITS]++] = in[i];
}

/* Deepest first. */
static enum status flood_all(struct flood *flood) {
  enum status status = STATUS_OK;
  const size_t n = flood->step[2] * flood->size[2];
  uint32_t *order = NULL;
  size_t count = 0;
  TRY(memory_allocate(&order, n, sizeof *order, "grains"));
  for (size_t i = 0; i < n; i++)
    if (flood->depth[i] > -BESIDE) order[count++] = (uint32_t)i;
  sort_half(flood->depth, order, count, 0, flood->part);
  sort_half(flood->depth, flood->part, count, HALF, order);
  memset(flood->part, 0, n * sizeof *flood->part);
  for (size_t i = 0; i < count; i++) TRY(flood_voxel(flood, order[i]));
cleanup:
  memory_free(&order);
  return status;
}

static void mark_contacts(struct flood *flood, uint8_t *contacts) {
  const size_t n = flood->step[2] * flood->size[2];
  memset(contacts, 0, n);
  for (size_t i = 0; i < n; i++)
    if (flood->part[i] != NOBODY) flood->part[i] = root_of(flood->parent, flood->part[i]);
  for (size_t i = 0; i < n; i++) {
    if (flood->part[i] == NOBODY) continue;
    for (int d = 0; d < 3; d++) {
      if (i / flood->step[d] % flood->size[d] + 1 == flood->size[d]) continue;
      const size_t next = i + flood->step[d];
      if (flood->part[next] == NOBODY || flood->part[next] == flood->part[i]) continue;
      contacts[i] |= (uint8_t)GRAINS_NEXT(d);
      contacts[next] |= (uint8_t)GRAINS_LAST(d);
    }
  }
}

enum status grains_find(const float *share, const size_t size[3], const double stretch[3],
                        uint8_t *contacts) {
  enum status status = STATUS_OK;
  struct flood flood = {.size = {size[0], size[1], size[2]},
                        .step = {1, size[0], size[0] * size[1]}};
  const size_t n = flood.step[2] * size[2];
  TRY(memory_allocate(&flood.depth, n, sizeof *flood.depth, "grains"));
  TRY(memory_allocate(&flood.part, n, sizeof *flood.part, "grains"));
  TRY(find_depths(share, stretch, &flood));
  TRY(flood_all(&flood));
  mark_contacts(&flood, contacts);
cleanup:
  memory_free(&flood.depth);
  memory_free(&flood.part);
  memory_free(&flood.parent);
  memory_free(&flood.peak);
  return status;
}
