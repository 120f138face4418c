/* Rain: a region that lets water fall at a given rate onto what lies below it. isph/rain.c; without
 * one nothing of it is called. */
#ifndef TOSUI_SPHSOLVE_ISPH_RAIN_H
#define TOSUI_SPHSOLVE_ISPH_RAIN_H

#include "sphsolve/isph/state.h"

/* Numbers are per m along y in 2-D. */
struct isph_rain {
  const struct region *region;
  double fallen, pending; /* kg: in whole particles; and since, less than one unless all is full */
  double places;          /* how many were tried: the next one's number */
};

/* Area that a region rains on, m^2 (m in 2-D). */
double isph_rain_area(const struct scene *scene, const struct region *rain);
enum status isph_rain_create(struct isph *s);
/* Collective, after the water has moved: books the rain of the step, and sets in whole particles
 * once it is that of one; leaves the particles unsorted. */
enum status isph_rain_fall(struct isph *s, double dt);

#endif
