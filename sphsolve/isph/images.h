/* Periodic and reflected images of neighbours. A particle far from periodic and reflecting sides
 * needs none. A loop over pairs is written as a ROW function with the kind of images as its first
 * argument; ISPH_ROW has it compiled for each kind, so that only the particles that have images pay
 * for them. */
#ifndef TOSUI_SPHSOLVE_ISPH_IMAGES_H
#define TOSUI_SPHSOLVE_ISPH_IMAGES_H

#include <stdbool.h>
#include <stdint.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/isph/vector.h"

enum isph_images { IMAGES_NONE, IMAGES_PERIODIC, IMAGES_REFLECTED /* and periodic ones */ };

#define ROW static inline __attribute__((always_inline))

/* Calls row(images, ...) for particle i of s, with the kind of images that it has. */
#define ISPH_ROW(s, i, row, ...)                                                                   \
  do {                                                                                             \
    if ((s)->images[i] == IMAGES_NONE)                                                             \
      row(IMAGES_NONE, __VA_ARGS__);                                                               \
    else if ((s)->images[i] == IMAGES_PERIODIC)                                                    \
      row(IMAGES_PERIODIC, __VA_ARGS__);                                                           \
    else                                                                                           \
      row(IMAGES_REFLECTED, __VA_ARGS__);                                                          \
  } while (0)

/* r = x_i - x_j for a pair entry. */
ROW void isph_separation_at(enum isph_images images, const struct isph *s, const double xi[3],
                            double (*x)[3], uint32_t entry, double r[3]) {
  const double *xj = x[entry & PAIR_MASK];
  const struct isph_image *image = &s->image[entry >> PAIR_BITS];
  for (int a = 0; a < 3; a++) {
    double at = xj[a];
    if (images == IMAGES_REFLECTED) at *= image->turn[a];
    if (images != IMAGES_NONE) at += image->shift[a];
    r[a] = xi[a] - at;
  }
}
ROW void isph_separation_four(enum isph_images images, const struct isph *s, size_t i,
                              uint32_t entry, four *r) {
  const struct isph_image *image = &s->image[entry >> PAIR_BITS];
  four at = FOUR(s->position[entry & PAIR_MASK]);
  if (images == IMAGES_REFLECTED) at *= FOUR(image->turn);
  if (images != IMAGES_NONE) at += FOUR(image->shift);
  *r = FOUR(s->position[i]) - at;
}
/* The same for eight pairs, with their neighbours j. */
ROW void isph_separation_eight(enum isph_images images, const struct isph *s, size_t i,
                               const uint32_t *entry, const uint32_t j[8], eight r[3]) {
  uint32_t code[8];
  for (int l = 0; l < 8 && images != IMAGES_NONE; l++) code[l] = entry[l] >> PAIR_BITS;
  for (int a = 0; a < 3; a++) {
    eight at = EIGHT_OF(s->position, j, [a]);
    if (images == IMAGES_REFLECTED) at *= EIGHT_OF(s->image, code, .turn[a]);
    if (images != IMAGES_NONE) at += EIGHT_OF(s->image, code, .shift[a]);
    r[a] = s->position[i][a] - at;
  }
}
/* The same for any kind of image. */
ROW void isph_separation(const struct isph *s, const double xi[3], double (*x)[3], uint32_t entry,
                         double r[3]) {
  isph_separation_at(IMAGES_REFLECTED, s, xi, x, entry, r);
}

/* Whether the neighbour of a pair entry is a reflected image. */
ROW bool isph_is_reflected(enum isph_images images, const struct isph *s, uint32_t entry) {
  return images == IMAGES_REFLECTED && s->image[entry >> PAIR_BITS].reflected;
}

/* A vector of the neighbour, turned as in its image. */
ROW void isph_turn(enum isph_images images, const struct isph *s, uint32_t entry,
                   const double of[3], double image[3]) {
  const double *turn = s->image[entry >> PAIR_BITS].turn;
  for (int a = 0; a < 3; a++) image[a] = images == IMAGES_REFLECTED ? turn[a] * of[a] : of[a];
}
ROW void isph_turn_four(enum isph_images images, const struct isph *s, uint32_t entry,
                        const double of[3], four *image) {
  *image = FOUR(of);
  if (images == IMAGES_REFLECTED) *image *= FOUR(s->image[entry >> PAIR_BITS].turn);
}

#endif
