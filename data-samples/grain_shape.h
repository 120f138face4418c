/* One grain of sand: a convex body of 10 to 15 faces with rounded edges, longer than wide and
 * wider than thick, described by its faces and by tables over a fixed set of directions. */
#ifndef TOSUI_DATA_SAMPLES_GRAIN_SHAPE_H
#define TOSUI_DATA_SAMPLES_GRAIN_SHAPE_H

#include <stdint.h>

#include "data-samples/counter_random.h"

#define GRAIN_FACES_MAX 15
#define GRAIN_TABLE 10 /* cells along an edge of the direction cube */
#define GRAIN_DIRECTIONS (6 * GRAIN_TABLE * GRAIN_TABLE)

struct grain {
  double centre[3];   /* m, in the periodic box of the packing */
  double diameter;    /* m, of the sphere of the same volume */
  double radius;      /* m, of the smallest sphere about the centre that holds the grain */
  double edge_radius; /* m, over which neighbouring faces round into each other */
  int faces;
  float normal[GRAIN_FACES_MAX][3];
  float distance[GRAIN_FACES_MAX];    /* m, from the centre to the face */
  float support[GRAIN_DIRECTIONS][3]; /* m, the surface point farthest along each direction */
};

/* Unit vectors through the cell centres of a cube's faces, with their shares of the sphere. */
struct direction_set {
  double direction[GRAIN_DIRECTIONS][3];
  double weight[GRAIN_DIRECTIONS];
};

void direction_set_create(struct direction_set *set);

/* The table cell that holds direction (x, y, z), not all 0. */
int direction_set_find(double x, double y, double z);

/* angular: as above; round: compact, and edges as wide as faces; long: twice as long as wide. */
enum grain_form { GRAIN_ANGULAR, GRAIN_ROUND, GRAIN_LONG };

/* What grains to draw. Fines are grains of a third of the diameter. */
struct grain_recipe {
  double smallest, largest; /* m: limits of the diameter */
  enum grain_form form;
  double fines; /* share of the solid's volume */
};

/* Share of the number of grains that are fines. */
double grain_fines_number(const struct grain_recipe *recipe);

/* The shape of grain number `item`, of volume pi/6 diameter^3. The centre is left at 0. */
void grain_create(struct grain *grain, const struct direction_set *set, uint64_t seed,
                  uint64_t item, const struct grain_recipe *recipe);

/* Rounded maximum of two face distances: max, plus a parabola where they are within `width`
 * (polynomial smooth maximum, Quilez 2013). */
static inline float grain_round(float a, float b, float width) {
  const float gap = a > b ? a - b : b - a;
  const float reach = gap < width ? width - gap : 0;
  return (a > b ? a : b) + reach * reach / (4 * width);
}

#endif
