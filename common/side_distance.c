#include "common/side_distance.h"

#include <math.h>

/* The way from a voxel's centre to the nearer side. */
static double room(size_t i, size_t n, double spacing) {
  return spacing * ((double)(i < n - 1 - i ? i : n - 1 - i) + 0.5);
}

/* The distance that the voxel's neighbours of the other phase leave it, by the nearest: the surface
 * lies between the two centres. INFINITY: none is there, or none has a distance of its own. */
static float between(const size_t n[3], const double spacing[3], const float *distance,
                     const size_t at[3]) {
  const size_t step[3] = {1, n[0], n[0] * n[1]};
  const size_t i = at[0] + at[1] * step[1] + at[2] * step[2];
  const float own = distance[i];
  float least = INFINITY;
  for (int a = 0; a < 3; a++)
    for (int side = -1; side <= 1; side += 2) {
      if (side < 0 ? at[a] == 0 : at[a] + 1 == n[a]) continue;
      const float other = distance[side < 0 ? i - step[a] : i + step[a]];
      if ((other < 0.0f) == (own < 0.0f)) continue;
      const double left = spacing[a] - fabs((double)other);
      least = fminf(least, (float)fmax(left, 0.05 * spacing[a]));
    }
  return own < 0.0f ? -least : least;
}

void side_distance_unwrap(const size_t n[3], const double spacing[3], const bool axes[2],
                          float *distance) {
  const size_t plane = n[0] * n[1];
  /* First what is next to the other phase, from distances that are still all there. */
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i < plane * n[2]; i++) {
      const size_t at[3] = {i % n[0], i / n[0] % n[1], i / plane};
      double reach = INFINITY;
      for (int a = 0; a < 2; a++)
        if (axes[a]) reach = fmin(reach, room(at[a], n[a], spacing[a]));
      if (!isfinite(distance[i]) || fabs((double)distance[i]) <= reach) continue;
      const float near = between(n, spacing, distance, at);
      if (pass == 0 && isfinite(near) && fabsf(near) > fabsf(distance[i])) distance[i] = near;
      if (pass == 1 && !isfinite(near)) distance[i] = INFINITY;
    }
}
