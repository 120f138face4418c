#include "sphsolve/isph/front.h"

#include <math.h>

#include "sphsolve/isph/images.h"

#define FRONT_FROM 0.9   /* of o */
#define FRONT_WEIGHT 0.1 /* at o = 1 */

ROW void add_pairs(enum isph_images images, const struct isph *s, const struct isph_chunk *chunk,
                   size_t i, double *sum) {
  const double *xi = s->position[i], *g = s->gradient_sum[i];
  double r[3];
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    isph_separation_at(images, s, xi, s->position, chunk->pair[p], r);
    *sum += s->volume[chunk->pair[p] & PAIR_MASK] * (double)chunk->slope[p] *
            fabs(r[0] * g[0] + r[1] * g[1] + r[2] * g[2]);
  }
  for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
    isph_separation_at(images, s, xi, s->boundary_position, chunk->wall[p], r);
    *sum += isph_wall_volume(s, chunk->wall[p] & PAIR_MASK) * (double)chunk->wall_slope[p] *
            fabs(r[0] * g[0] + r[1] * g[1] + r[2] * g[2]);
  }
}

void isph_front_find(struct isph *s, const struct isph_chunk *chunk, size_t i) {
  const double *g = s->gradient_sum[i];
  double sum = 0;
  if (s->soil_fraction[i] == 0 || s->surface[i] >= FRONT_WEIGHT) return;
  ISPH_ROW(s, i, add_pairs, s, chunk, i, &sum);
  if (!(sum > 0)) return;
  const double o = (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]) / sum;
  s->surface[i] = fmax(s->surface[i], FRONT_WEIGHT * (o - FRONT_FROM) / (1 - FRONT_FROM));
}
