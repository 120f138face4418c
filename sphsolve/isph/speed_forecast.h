/* Forecast of the speed of the water in a scene, for the forecast of its time steps, and of its
 * Reynolds number. */
#ifndef TOSUI_SPHSOLVE_ISPH_SPEED_FORECAST_H
#define TOSUI_SPHSOLVE_ISPH_SPEED_FORECAST_H

#include "common/error.h"
#include "sphsolve/plan/plan.h"

struct isph_speed_forecast {
  double speed;       /* m/s, speed of the fastest water at first */
  double lasts;       /* s, how long it lasts; INFINITY: to the end */
  double speed_after; /* m/s, speed after that */
};

/* The largest velocity, m/s, that a region has or gives to the water: of walls, soils, inflows,
 * water at the start, rain, and of a well the velocity through the faces of its extent. */
double isph_region_speed(const struct scene *scene, const struct region *region);
/* The largest of these over all regions. */
double isph_prescribed_speed(const struct scene *scene);
/* Driving acceleration of the heads, m/s^2: g times their largest difference over the shortest
 * length of the domain. */
double isph_head_drive(const struct scene *scene);

/* Predicts the speeds from the lattice and the regions alone, before a run; fails only for lack of
 * memory. */
enum status isph_speed_predict(const struct effect_context *context,
                               struct isph_speed_forecast *speeds);
/* Reynolds number U R/nu of the free water, at most: U the largest of these speeds, R the hydraulic
 * radius of the water at the start or, if that is more, the largest length of a window. 0: still.
 */
enum status isph_reynolds_predict(const struct effect_context *context, double *reynolds);

#endif
