#include "sphsolve/geometry/wall_shape.h"

#include <math.h>

#define GRADIENT_MIN                                                                               \
  0.9 /* smallest gradient of a true distance to one surface: its gradient is 1 */
#define CURVATURE_MAX 0.5 /* 1/spacing; beyond, the curvature is noise */
#define NORMAL_MIN 0.5    /* a smaller gradient has no direction */

void wall_shape_find(const struct lattice *l, size_t site, double spacing,
                     struct wall_shape *shape) {
  const float *field = l->wall_distance;
  double square = 0, bend = 0;
  size_t step = 1;
  *shape = (struct wall_shape){.distance = (double)field[site]};
  for (int a = 0; a < 3; step *= l->size[a++]) {
    if (l->dimensions == 2 && a == 1) continue;
    const size_t at = site / step % l->size[a], back = (l->size[a] - 1) * step;
    const double high = (double)field[at + 1 < l->size[a] ? site + step : site - back];
    const double low = (double)field[at > 0 ? site - step : site + back], h = l->spacing[a];
    shape->normal[a] = (high - low) / (2 * h);
    square += shape->normal[a] * shape->normal[a];
    bend += (high + low - 2 * shape->distance) / (h * h);
  }
  const double length = sqrt(square), most = CURVATURE_MAX / spacing;
  const bool flat = length < GRADIENT_MIN || length > 2 - GRADIENT_MIN;
  shape->curvature = flat ? 0 : fmax(-most, fmin(bend, most));
  for (int a = 0; a < 3; a++)
    shape->normal[a] = length < NORMAL_MIN ? 0 : shape->normal[a] / length;
}
