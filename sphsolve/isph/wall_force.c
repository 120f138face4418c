#include "sphsolve/isph/wall_force.h"

#include <string.h>

#include "sphsolve/isph/images.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/wall.h"

/* Sum over the pairs of water and wall, as in the budget of momentum: a wall particle j has the
 * pressure of the water particle i of the pair, extrapolated hydrostatically, so that the pair
 * carries
 *   V_i V_j slope_ij (2 P_i - rho f.r) r.
 * For a plane this is the pressure on its face times its area (Monaghan 2005, Rep. Prog. Phys. 68,
 * on forces between particles of two bodies). */
void isph_wall_force(const struct isph *s, size_t b, double force[3]) {
  double f[3];
  for (int a = 0; a < 3; a++) f[a] = s->periodic[a] ? 0 : s->force[a];
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    const struct isph_chunk *chunk = &s->chunks[c];
    double sum[3] = {0};
    for (size_t i = chunk->begin; i < chunk->end; i++)
      for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
        const uint32_t entry = chunk->wall[p], j = entry & PAIR_MASK;
        double r[3];
        const size_t box = s->boundary_box[j];
        if (s->boundary_kind[j] != BOUNDARY_WALL || box == 0) continue;
        if (s->wall_boxes[box].region->first != s->wall_boxes[b].region->first) continue;
        isph_separation(s, s->position[i], s->boundary_position, entry, r);
        double along = 0;
        /* the component of a reflected wall's force normal to the side cancels */
        for (int a = 0; a < 3; a++) {
          const bool turned = s->image[entry >> PAIR_BITS].turn[a] < 0;
          along += f[a] * (turned ? s->position[i][a] - s->boundary_position[j][a] : r[a]);
          if (turned) r[a] = 0;
        }
        const double weight = s->volume[i] * isph_wall_volume(s, j) * (double)chunk->wall_slope[p] *
                              (2 * s->pressure[i] - s->density * along);
        for (int a = 0; a < 3; a++) sum[a] -= weight * r[a];
      }
    memcpy(s->sums[c], sum, sizeof sum);
  }
  isph_sum_chunks(s, 3, force);
  for (int a = 0; a < 3; a++) force[a] *= s->thickness;
  if (s->dimensions == 2) force[1] = 0;
}
