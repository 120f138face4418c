/* A packing of grains in a periodic box, at a given solid fraction, in which every grain touches
 * its neighbours: overlaps push apart, narrow gaps pull together, until both have settled. */
#ifndef TOSUI_DATA_SAMPLES_GRAIN_PACKING_H
#define TOSUI_DATA_SAMPLES_GRAIN_PACKING_H

#include "data-samples/grain_shape.h"

struct grain_packing {
  double box[3]; /* m; x, y, z */
  long count;
  struct grain *grain;
};

/* Draws grains until they fill `solid_fraction` of the box, and packs them. Deterministic for a
 * seed, for any number of threads. Free with _destroy. */
enum status grain_packing_create(struct grain_packing *packing, const double box[3],
                                 double solid_fraction, const struct grain_recipe *recipe,
                                 uint64_t seed);
void grain_packing_destroy(struct grain_packing *packing);

#endif
