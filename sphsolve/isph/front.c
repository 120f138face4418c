#include "sphsolve/isph/front.h"

#include <math.h>

#include "sphsolve/isph/effects/surface.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/vector.h"
#include "sphsolve/isph/wall.h"
#include "sphsolve/isph/constants.h"

/* Sums over a neighbourhood, without walls beyond a void: `open` is sum V grad W, `across` is sum
 * |V grad W.g| with g the gradient sum including all walls. `beyond` is the second moment of the
 * walls that are left out. */
struct sides {
  double open[3], across, beyond[6];
};

/* Linear ramp: 0 up to `from`, 1 from `full` on. */
static double share(double a, double from, double full) {
  return fmax(0, fmin(1, (a - from) / (full - from)));
}

ROW void add_pairs(enum isph_images images, const struct isph *s, const struct isph_chunk *chunk,
                   size_t i, struct sides *sides) {
  const double *xi = s->position[i], *g = s->gradient_sum[i];
  double r[3];
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    isph_separation_at(images, s, xi, s->position, chunk->pair[p], r);
    sides->across +=
        s->volume[chunk->pair[p] & PAIR_MASK] * (double)chunk->slope[p] * fabs(dot(r, g));
  }
}

static void add_walls(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                      struct sides *sides) {
  const double *xi = s->position[i], *g = s->gradient_sum[i];
  for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
    const size_t j = chunk->wall[p] & PAIR_MASK;
    double r[3], mirror[6], gap = 0, *beyond = sides->beyond;
    isph_separation(s, xi, s->boundary_position, chunk->wall[p], r);
    if (s->boundary_kind[j] != BOUNDARY_OPEN_HEAD) {
      const double xj[3] = {xi[0] - r[0], xi[1] - r[1], xi[2] - r[2]};
      isph_wall_mirror(s, i, j, xj, mirror, NULL);
      gap = surface_gap(s, i, r, mirror);
    }
    const double f = isph_wall_volume(s, j) * (double)chunk->wall_slope[p], out = gap * f;
    sides->across += (f - out) * fabs(dot(r, g));
    for (int a = 0; a < 3; a++) sides->open[a] -= out * r[a];
    beyond[0] += out * r[0] * r[0], beyond[1] += out * r[0] * r[1], beyond[2] += out * r[0] * r[2];
    beyond[3] += out * r[1] * r[1], beyond[4] += out * r[1] * r[2], beyond[5] += out * r[2] * r[2];
  }
}

double isph_front_find(struct isph *s, const struct isph_chunk *chunk, size_t i, double moment[6]) {
  double *g = s->gradient_sum[i];
  struct sides sides = {.open = {g[0], g[1], g[2]}};
  if (s->soil_fraction[i] == 0) return 0;
  ISPH_ROW(s, i, add_pairs, s, chunk, i, &sides);
  add_walls(s, chunk, i, &sides);
  if (!(sides.across > 0)) return 0;
  const double *open = sides.open, o = dot(open, g) / sides.across;
  const double left = share(sqrt(dot(g, g) / dot(open, open)), VOID_SHUT, VOID_OPEN);
  const double *beyond = sides.beyond;
  const double trace = moment[0] + moment[3] + moment[5] - beyond[0] - beyond[3] - beyond[5];
  const double asymmetry = surface_asymmetry(s, s->support[i], open, trace);
  double w = FRONT_WEIGHT * share(o, FRONT_FROM, 1);
  if (trace > 0) w = fmax(w, share(asymmetry, SURFACE_FROM, SURFACE_FULL));
  s->surface[i] = fmax(s->surface[i], left * w);
  for (int a = 0; a < 3; a++) g[a] += left * (open[a] - g[a]);
  for (int k = 0; k < 6; k++) moment[k] -= left * beyond[k];
  return left * share(o, ONE_SIDED_FROM, ONE_SIDED_FULL);
}
