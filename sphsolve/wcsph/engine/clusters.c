#include "sphsolve/wcsph/engine/clusters.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* Largest growth of a box, in fixed-point units: a quarter of the range keeps differences
 * unambiguous. */
#define GROWTH_MAX 0x1p29

/* Box around members whose extent is given relative to `first`. */
static void box_of(const uint32_t first[3], const int64_t low[3], const int64_t high[3],
                   struct cluster_box *box) {
  for (int a = 0; a < 3; a++) {
    int64_t span = high[a] - low[a];
    box->centre[a] = first[a] + (uint32_t)low[a] + (uint32_t)(span / 2);
    box->half[a] = (uint32_t)(span - span / 2);
  }
}

enum status cluster_boxes_fluid(const struct particles *p, double horizon, double swerve,
                                double margin, struct cluster_set *set) {
  enum status status = STATUS_OK;
  double per_unit[3];
  for (int a = 0; a < 3; a++) per_unit[a] = p->frame.step[a] == 0 ? 0 : 1 / p->frame.unit[a];
  if (set->clusters != p->clusters) {
    memory_free(&set->boxes);
    set->clusters = p->clusters;
    TRY(memory_allocate(&set->boxes, p->clusters, sizeof *set->boxes, "cluster boxes"));
  }
#pragma omp parallel for schedule(static)
  for (size_t c = set->begin; c < set->end; c++) {
    size_t first = c * CLUSTER; /* the first slot of a cluster is never empty */
    int64_t low[3] = {INT64_MAX, INT64_MAX, INT64_MAX}, high[3] = {INT64_MIN, INT64_MIN, INT64_MIN};
    uint32_t origin[3] = {p->x[0][first], p->x[1][first], p->x[2][first]};
    for (size_t i = first; i < first + CLUSTER; i++) {
      if (p->id[i] == NO_PARTICLE) continue;
      for (int a = 0; a < 3; a++) {
        double path = (double)p->v[a][i];
        if (p->shift[0] != NULL) path += (double)p->shift[a][i];
        path *= horizon * per_unit[a];
        double around = fabs(path) * swerve + margin * per_unit[a];
        double back = fmax(fmin(path, 0) - around, -GROWTH_MAX);
        double ahead = fmin(fmax(path, 0) + around, GROWTH_MAX);
        int32_t at = (int32_t)(p->x[a][i] - origin[a]);
        int64_t from = at + (int64_t)back, to = at + (int64_t)ahead;
        low[a] = from < low[a] ? from : low[a];
        high[a] = to > high[a] ? to : high[a];
      }
    }
    box_of(origin, low, high, &set->boxes[c]);
  }
cleanup:
  return status;
}

enum status cluster_boxes_wall(const struct particles *p, struct cluster_set *set) {
  enum status status = STATUS_OK;
  set->clusters = set->end = p->wall_clusters;
  TRY(memory_allocate(&set->boxes, p->wall_clusters, sizeof *set->boxes, "cluster boxes"));
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < p->wall_clusters; c++) {
    size_t first = c * CLUSTER;
    int64_t low[3] = {0}, high[3] = {0};
    uint32_t origin[3];
    for (int a = 0; a < 3; a++) origin[a] = frame_wall_position(&p->frame, a, p->site[first]);
    for (size_t i = first + 1; i < first + CLUSTER; i++) {
      if (p->site[i] == NO_SITE) continue;
      for (int a = 0; a < 3; a++) {
        int32_t at = (int32_t)(frame_wall_position(&p->frame, a, p->site[i]) - origin[a]);
        low[a] = at < low[a] ? at : low[a];
        high[a] = at > high[a] ? at : high[a];
      }
    }
    box_of(origin, low, high, &set->boxes[c]);
  }
cleanup:
  return status;
}

void cluster_set_free(struct cluster_set *set) {
  memory_free(&set->boxes);
  set->clusters = 0;
}

static size_t cell_of(const struct frame *frame, const struct cluster_bins *bins,
                      const uint32_t at[3]) {
  size_t cell[3];
  for (int a = 0; a < 3; a++) {
    /* A centre may lie in an image of the box: fold it back. */
    const uint32_t folded = at[a] << frame->image_bits[a];
    cell[a] = ((uint64_t)folded * (uint64_t)bins->cells[a]) >> 32;
  }
  return (cell[2] * (size_t)bins->cells[1] + cell[1]) * (size_t)bins->cells[0] + cell[0];
}

enum status cluster_bins_make(const struct frame *frame, const struct cluster_set *set, double size,
                              struct cluster_bins *bins) {
  enum status status = STATUS_OK;
  size_t cells = 1, n = set->clusters;
  memset(bins, 0, sizeof *bins);
  bins->clusters = n;
  for (int a = 0; a < 3; a++) {
    bins->cells[a] = frame->step[a] == 0 ? 1 : (int)fmin(1024, fmax(1, frame->length[a] / size));
    cells *= (size_t)bins->cells[a];
  }
  TRY(memory_allocate(&bins->start, cells + 2, sizeof *bins->start, "cluster cells"));
  TRY(memory_allocate(&bins->member, n, sizeof *bins->member, "cluster cells"));
  for (size_t c = 0; c < n; c++) bins->start[cell_of(frame, bins, set->boxes[c].centre) + 2]++;
  for (size_t i = 2; i < cells + 2; i++) bins->start[i] += bins->start[i - 1];
  for (size_t c = 0; c < n; c++)
    bins->member[bins->start[cell_of(frame, bins, set->boxes[c].centre) + 1]++] = (uint32_t)c;
  for (int a = 0; a < 3; a++) {
    TRY(memory_allocate(&bins->centre[a], n, sizeof **bins->centre, "cluster cells"));
    TRY(memory_allocate(&bins->half[a], n, sizeof **bins->half, "cluster cells"));
    for (size_t m = 0; m < n; m++) {
      const struct cluster_box *box = &set->boxes[bins->member[m]];
      bins->centre[a][m] = (uint16_t)(box->centre[a] >> 16);
      /* The stored centre deviates by up to 2^15 units. */
      bins->half[a][m] = (uint16_t)((box->half[a] + 0x17fffu) >> 16);
      const uint32_t half = cluster_bins_half(bins, a, m);
      if (half > bins->half_max[a]) bins->half_max[a] = half;
    }
  }
cleanup:
  if (status != STATUS_OK) cluster_bins_free(bins);
  return status;
}

void cluster_bins_free(struct cluster_bins *bins) {
  MEMORY_FREE(&bins->start, &bins->member);
  for (int a = 0; a < 3; a++) {
    MEMORY_FREE(&bins->centre[a], &bins->half[a]);
  }
}
