/* The fixed-point frame of positions: they are fractions of the box, so that differences are exact
 * and periodic without extra cost. A box narrower than the reach of the kernel is repeated 2, 4,
 * ... times. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_FRAME_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_FRAME_H

#include <stddef.h>
#include <stdint.h>

struct lattice; /* geometry/lattice.h */

#define CLUSTER 8 /* slots of a cluster, the unit of the neighbour lists */

/* Fixed-point coordinates: 2^32 units span 2^image_bits boxes. */
struct frame {
  int dimensions;
  size_t sites[3];
  double length[3]; /* m, of the box */
  int image_bits[3];
  double unit[3];   /* m per unit */
  uint32_t step[3]; /* units per site; 0: no such direction (y in 2-D) */
  /* Bit position and mask of x, y, z in a packed site. */
  int site_shift[3];
  uint32_t site_mask[3];
};

/* `clearance`: smallest total length of the box's images, m: twice the reach of any pair of
 * clusters. */
void frame_make(const struct lattice *lattice, double clearance, struct frame *frame);

/* Particles may move into images of the box; this is the position within the box itself. */
static inline uint32_t frame_fold(const struct frame *frame, int axis, uint32_t x) {
  return x & (UINT32_MAX >> frame->image_bits[axis]);
}
static inline uint32_t frame_site_position(const struct frame *frame, int axis, uint32_t index) {
  return index * frame->step[axis] + frame->step[axis] / 2;
}
static inline uint32_t frame_wall_index(const struct frame *frame, int axis, uint32_t site) {
  return site >> frame->site_shift[axis] & frame->site_mask[axis];
}
static inline uint32_t frame_wall_position(const struct frame *frame, int axis, uint32_t site) {
  return frame_site_position(frame, axis, frame_wall_index(frame, axis, site));
}

#endif
