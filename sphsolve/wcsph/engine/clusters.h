/* Bounding boxes of clusters, and the cells they are looked up by when lists are made. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_CLUSTERS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_CLUSTERS_H

#include "sphsolve/wcsph/engine/particles.h"

struct cluster_box {
  uint32_t centre[3];
  uint32_t half[3]; /* fixed-point units */
};

struct cluster_set {
  size_t clusters;
  size_t begin, end; /* those of this rank: rows of lists */
  struct cluster_box *boxes;
};

/* Of clusters set->begin to end: boxes that hold each fluid particle for `horizon` seconds if it
 * goes on as it does: the path to come, and around it `swerve` of its length and `margin` (m). */
enum status cluster_boxes_fluid(const struct particles *particles, double horizon, double swerve,
                                double margin, struct cluster_set *set);
/* Walls stay where they are: their boxes are exact. */
enum status cluster_boxes_wall(const struct particles *particles, struct cluster_set *set);
void cluster_set_free(struct cluster_set *set);

/* Clusters by the cell of their centre; members of a cell, and cells along x, lie side by side. */
struct cluster_bins {
  size_t clusters;
  int cells[3];
  uint32_t *start, *member;
  uint16_t *centre[3],
      *half[3]; /* of the members, in their order: upper halves of boxes around theirs */
  uint32_t half_max[3];
};
static inline uint32_t cluster_bins_centre(const struct cluster_bins *bins, int axis, size_t m) {
  return (uint32_t)bins->centre[axis][m] << 16 | 0x8000u;
}
static inline uint32_t cluster_bins_half(const struct cluster_bins *bins, int axis, size_t m) {
  return (uint32_t)bins->half[axis][m] << 16;
}

/* Cells at least `size` m wide. */
enum status cluster_bins_make(const struct frame *frame, const struct cluster_set *set, double size,
                              struct cluster_bins *bins);
void cluster_bins_free(struct cluster_bins *bins);

#endif
