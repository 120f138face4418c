/* What a pair of particles beside closed sides counts more in the pressure's rows in soil: the
 * images of its particle j behind them, where the pressure less rho f.x is that of j. Without them
 * the rows beside a side have four fifths of their weight along it: to a drain that ends there, the
 * soil is a fifth of a particle thinner at each side. No image is a pair of its own, as j itself is
 * nearer. (Mirror images: Colagrossi, Landrini 2003; of free water they are neighbours:
 * reflection.h.) */
#ifndef TOSUI_SPHSOLVE_ISPH_SIDE_IMAGE_H
#define TOSUI_SPHSOLVE_ISPH_SIDE_IMAGE_H

#include <stdbool.h>
#include <stddef.h>

#include "sphsolve/isph/state.h"

/* An image of particle j: x_i - x of it, the slope of its pair, and of each axis whether it is
 * turned, and at which place, m. */
struct isph_side_image {
  double r[3], slope, plane[3];
  bool turned[3];
};
/* Low and high side of each axis, each with none. */
#define SIDE_IMAGES 26

/* Whether particle i is beside a closed side, in a scene with soil and without a surface. */
bool isph_has_side_images(const struct isph *s, size_t i);
/* The images of j for such a particle i, with r = x_i - x_j; returns their number. */
size_t isph_side_images(const struct isph *s, size_t i, size_t j, const double r[3],
                        struct isph_side_image images[SIDE_IMAGES]);
/* The sum of their slopes. */
double isph_side_slope(const struct isph *s, size_t i, size_t j, const double r[3]);

#endif
