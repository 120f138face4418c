/* Bounding boxes of clusters, and the cell bins used to find neighbouring clusters. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_CLUSTERS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_CLUSTERS_H

#include "sphsolve/wcsph/engine/particles.h"

struct cluster_box {
  uint32_t centre[3];
  uint32_t half[3]; /* fixed-point units */
};

struct cluster_set {
  size_t clusters;
  size_t begin, end; /* clusters of this rank, the rows of its lists */
  struct cluster_box *boxes;
};

/* Boxes of the clusters set->begin to end that contain each fluid particle for `horizon` seconds at
 * its present velocity: its path, extended on all sides by `swerve` times its length and `margin`
 * (m). */
enum status cluster_boxes_fluid(const struct particles *particles, double horizon, double swerve,
                                double margin, struct cluster_set *set);
/* Exact boxes of wall clusters, which do not move. */
enum status cluster_boxes_wall(const struct particles *particles, struct cluster_set *set);
void cluster_set_free(struct cluster_set *set);

/* Clusters sorted by the cell of their centre; the members of a cell, and of cells along x, are
 * contiguous. */
struct cluster_bins {
  size_t clusters;
  int cells[3];
  uint32_t *start, *member;
  /* Of the members in their order: upper 16 bits of boxes that enclose theirs. */
  uint16_t *centre[3], *half[3];
  uint32_t half_max[3];
};
static inline uint32_t cluster_bins_centre(const struct cluster_bins *bins, int axis, size_t m) {
  return (uint32_t)bins->centre[axis][m] << 16 | 0x8000u;
}
static inline uint32_t cluster_bins_half(const struct cluster_bins *bins, int axis, size_t m) {
  return (uint32_t)bins->half[axis][m] << 16;
}

/* Makes cells that are at least `size` m wide. */
enum status cluster_bins_make(const struct frame *frame, const struct cluster_set *set, double size,
                              struct cluster_bins *bins);
void cluster_bins_free(struct cluster_bins *bins);

#endif
