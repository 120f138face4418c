#include "sphsolve/wcsph/engine/frame.h"
#include "sphsolve/geometry/lattice.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define MAX_IMAGE_BITS 6

void frame_make(const struct lattice *lattice, double clearance, struct frame *frame) {
  memset(frame, 0, sizeof *frame);
  int bits = 0;
  frame->dimensions = lattice->dimensions;
  for (int a = 0; a < 3; a++) {
    frame->sites[a] = lattice->size[a];
    frame->length[a] = lattice->spacing[a] * (double)lattice->size[a];
    bool flat = lattice->dimensions == 2 && a == 1;
    if (!flat)
      while (ldexp(frame->length[a], frame->image_bits[a]) < clearance &&
             frame->image_bits[a] < MAX_IMAGE_BITS)
        frame->image_bits[a]++;
    frame->unit[a] = ldexp(frame->length[a], frame->image_bits[a] - 32);
    double step = ldexp(1.0, 32 - frame->image_bits[a]) / (double)lattice->size[a];
    frame->step[a] = flat ? 0 : (uint32_t)fmin(step, (double)UINT32_MAX);
    frame->site_shift[a] = a == 0 ? 0 : frame->site_shift[a - 1] + bits;
    for (bits = 1; lattice->size[a] >> bits != 0; bits++) {
    }
    frame->site_mask[a] = (uint32_t)((1ull << bits) - 1);
  }
}
