/* Rain: a region from which water falls at a given rate onto what lies below it. See isph/rain.c,
 * of which nothing is called without such a region. */
#ifndef TOSUI_SPHSOLVE_ISPH_RAIN_H
#define TOSUI_SPHSOLVE_ISPH_RAIN_H

#include "sphsolve/isph/state.h"

/* A rain. In 2-D its amounts are per m along y. */
struct isph_rain {
  const struct region *region;
  /* kg: fallen as whole particles; and not yet, less than one particle unless there is no room */
  double fallen, pending;
  double places; /* number of places tried so far, which is the number of the next */
};

/* Area that a region rains on, m^2 (m in 2-D). */
double isph_rain_area(const struct scene *scene, const struct region *rain);
/* Sets up the rains of the scene; isph_free frees them. */
enum status isph_rain_create(struct isph *s);
/* Collective, after the water has moved: adds the rain of the step to `pending`, and adds particles
 * while that is the mass of one; leaves the particles unsorted. */
enum status isph_rain_fall(struct isph *s, double dt);

#endif
