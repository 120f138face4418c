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

static size_t wrapped(size_t at, int step, size_t size) {
  return (at + size + (size_t)step) % size;
}

static double distance_at(const struct lattice *l, const size_t at[3], const int step[3]) {
  size_t to[3];
  for (int a = 0; a < 3; a++) to[a] = wrapped(at[a], step[a], l->size[a]);
  return l->wall_distance[(to[2] * l->size[1] + to[1]) * l->size[0] + to[0]];
}

double wall_curvature(const struct lattice *l, const size_t at[3]) {
  /* One of each pair of opposite neighbours. */
  static const int steps[13][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 0},  {1, -1, 0},
                                   {1, 0, 1},  {1, 0, -1}, {0, 1, 1},  {0, 1, -1}, {1, 1, 1},
                                   {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
  static const int none[3] = {0, 0, 0};
  double largest = 0.0;
  if (l->wall_distance == NULL) return 0.0;
  const double d = distance_at(l, at, none);
  for (int n = 0; n < 13; n++) {
    const int *step = steps[n], back[3] = {-step[0], -step[1], -step[2]};
    double square = 0.0;
    bool is_line = true;
    for (int a = 0; a < 3; a++) {
      is_line = is_line && (step[a] == 0 || l->size[a] > 1);
      square += step[a] * step[a] * l->spacing[a] * l->spacing[a];
    }
    if (!is_line) continue;
    const double second = distance_at(l, at, step) - 2.0 * d + distance_at(l, at, back);
    largest = fmax(largest, second / square);
  }
  const double left = 1.0 - largest * d;
  return left > 0.0 ? largest / left : INFINITY;
}
