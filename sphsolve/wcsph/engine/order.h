/* The order of particles along the curve, and where it is cut into clusters. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ORDER_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ORDER_H

#include "sphsolve/wcsph/engine/particles.h"

int order_bits(const struct frame *frame);
/* `cell`: position in half sites. */
uint32_t order_key(const struct frame *frame, int bits, const uint32_t cell[3]);
/* Sorts entries by their upper 32 bits, stably; `scratch` has as much room. */
void order_sort(uint64_t *entries, uint64_t *scratch, size_t n);

/* Grows a cluster one member at a time and says when the next would make it too wide. */
struct cutter {
  const struct frame *frame;
  int64_t limit[3];
  uint32_t first[3];
  int64_t low[3], high[3];
  int members;
};
void cutter_start(struct cutter *cutter, const struct frame *frame, double reach);
bool cutter_takes(struct cutter *cutter, const uint32_t x[3]);

/* Walls of planes [first, end) that fluid can reach, in the order of sites; *sites is to be freed.
 */
enum status particles_find_walls(const struct lattice *lattice, double range, size_t first,
                                 size_t end, uint32_t **sites, size_t *count);
/* Makes walls of sites in order; empty slots carry NO_PARTICLE. */
enum status particles_set_walls(const struct lattice *lattice, double range,
                                const struct particle_fields *fields, const uint32_t *order,
                                size_t used, struct particles *particles);

#endif
