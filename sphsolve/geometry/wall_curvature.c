#include "sphsolve/geometry/wall_curvature.h"

#include <math.h>

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
