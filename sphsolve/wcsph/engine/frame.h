/* The fixed-point frame that positions are held in: fractions of the box, so that differences are
 * exact and periodic for free. A box narrower than the kernel's reach is taken 2, 4, ... times. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_FRAME_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_FRAME_H

#include <stddef.h>
#include <stdint.h>

struct lattice; /* geometry/lattice.h */

#define CLUSTER 8 /* slots of the unit of the neighbour lists */

/* Fixed-point coordinates: 2^32 units span 2^image_bits boxes. */
struct frame {
  int dimensions;
  size_t sites[3];
  double length[3]; /* m: the box */
  int image_bits[3];
  double unit[3];   /* m per unit */
  uint32_t step[3]; /* units per site; 0: no such direction (y in 2-D) */
  /* Where x, y, z stand in a packed site, and what one more than the largest takes. */
  int site_shift[3];
  uint32_t site_mask[3];
};

/* `clearance`: least length of the box's images, m: twice the reach of any pair of clusters. */
void frame_make(const struct lattice *lattice, double clearance, struct frame *frame);

/* Particles drift on into images of the box; this is their place in the box itself. */
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
