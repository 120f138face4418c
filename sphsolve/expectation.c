#include "sphsolve/expectation.h"

#include <math.h>
#include <stdio.h>

void pore_shape_find(const struct scene *scene, const struct lattice *l, struct pore_shape *shape) {
  const size_t step[3] = {1, l->size[0], l->size[0] * l->size[1]};
  double faces = 0.0, half = 0.0;
  int axes = 0;
  *shape = (struct pore_shape){INFINITY, INFINITY, .straight = !*scene->model_path};
  if (l->wall_count == 0) return;
  for (int a = 0; a < 3; a++) {
    double here = 0.0;
    for (size_t site = 0; site < l->count; site++) {
      const bool last = site / step[a] % l->size[a] + 1 == l->size[a];
      const size_t next = last ? site - (l->size[a] - 1) * step[a] : site + step[a];
      if (l->kind[site] == l->kind[next]) continue;
      const size_t fluid = l->kind[site] == SITE_FLUID ? site : next;
      here += 1.0;
      half += fabs((double)l->wall_distance[fluid] / l->spacing[a] - 0.5) < 1e-3;
    }
    axes += here > 0.0;
    faces += here;
  }
  if (!(faces > 0.0)) return;
  const double surface = faces * 2.0 / 3.0, grains = (double)(l->bulk_count - l->fluid_count);
  shape->width = 4.0 * (double)l->fluid_count / surface;
  shape->bend = sqrt(shape->width * 3.0 * grains / surface);
  shape->flat = shape->straight && axes == 1;
  shape->faces = half > 0.9 * faces;
}

/* Constants measured by method stokes (make tradeoff draws them): slits and square ducts of 4 to 32
 * sites, simple cubic spheres of c = .216 and .45 at 8 to 48 a side, a synthetic sand at 30 to 240.
 * frozen    error x width: slits 9.9 to 11, ducts 6.5 to 7.9, spheres 4 to 12, sand 8 to 11
 * adami     error x width^2: slits 22 to 27, ducts 11 to 13, spheres 9 to 64, sand 15 to 16
 * subvoxel  between straight walls of ducts error x width^2 = .6 to 1.2; slits exact with stokes
 * and 4.5/width^2 (the midpoint rule) with wcsph; curved walls third order in the bend. */
double expect_error(const struct pore_shape *shape, enum method method, enum wall_scheme wall,
                    double refined, char why[EFFECT_WHY]) {
  const double width = shape->width * refined, bend = shape->bend * refined;
  const char *how = "walls from the wall distance";
  double error;
  if (!isfinite(width)) {
    snprintf(why, EFFECT_WHY, "no walls");
    return NAN;
  }
  if (wall == WALL_FROZEN) {
    error = fmin(8.0 / width, 6.0);
    how = "frozen walls: every gap a site too wide";
  } else if (wall == WALL_ADAMI) {
    error = fmin(17.0 / (width * width), 4.0);
    how = "adami walls: half a site behind the sites";
  } else if (shape->flat) {
    error = method == METHOD_STOKES ? 1e-6 : 4.5 / (width * width);
    how = method == METHOD_STOKES ? "parallel flat walls: exact but for the solver"
                                  : "parallel flat walls: the sum over particles";
  } else if (shape->straight) {
    error = fmin(1.0 / (width * width), 1.0);
    how = "straight walls: second order";
  } else if (shape->faces) {
    error = fmin(3.0 / width, 2.0);
    how = "walls are voxel faces, full of edges: first order";
  } else {
    error = fmin(21.0 / (bend * bend * (bend + 2.0)), 3.0);
  }
  snprintf(why, EFFECT_WHY, "pores %.1f sites wide on the average; %s", width, how);
  return error;
}
