/* How fast the water of a scene will move, for the forecast of its time steps. */
#ifndef TOSUI_SPHSOLVE_ISPH_SPEED_FORECAST_H
#define TOSUI_SPHSOLVE_ISPH_SPEED_FORECAST_H

#include "common/error.h"
#include "sphsolve/plan/plan.h"

struct isph_speed_forecast {
  double speed;       /* m/s, of the fastest water, while what drives it lasts */
  double lasts;       /* s; INFINITY: to the end */
  double speed_after; /* m/s */
};

/* The largest velocity, m/s, that a region gives to the water or itself has: walls, soils, inflows,
 * water at the start, rain, and a well through the faces of its extent. */
double isph_region_speed(const struct scene *scene, const struct region *region);
/* The same of all regions. */
double isph_prescribed_speed(const struct scene *scene);
/* What heads drive water with, m/s^2: g times their difference over the domain's length from one to
 * another. */
double isph_head_drive(const struct scene *scene);

/* From the lattice and the regions alone, before a run; fails for want of memory. */
enum status isph_speed_predict(const struct effect_context *context,
                               struct isph_speed_forecast *speeds);

#endif
