#include "sphsolve/isph/biharmonic.h"

#include "common/variants.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/constants.h"

/* Sets `sum` to L u = - sum 2 V slope (u_i - u_j) of particle i over its pairs with water. In
 * laminar flow velocities behind a closed side that holds the water have the opposite sign, so that
 * shear at the side is none of its curvature; a turbulent boundary layer is thinner than particles.
 */
ROW void laplacian(enum isph_images images, const struct isph *s, const struct isph_chunk *chunk,
                   size_t i, double (*u)[3], double sum[3]) {
  four all = {0};
  const bool held = isph_sides_hold(s) && !s->on.turbulence;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const uint32_t j = chunk->pair[p] & PAIR_MASK;
    const double weight = 2 * s->volume[j] * (double)chunk->slope[p];
    four uj;
    isph_turn_four(images, s, chunk->pair[p], u[j], &uj);
    if (held && isph_is_reflected(images, s, chunk->pair[p])) uj = -FOUR(u[j]);
    all -= weight * (FOUR(u[i]) - uj);
  }
  for (int a = 0; a < 3; a++) sum[a] = all[a];
}

TARGETS static void find_curvature(const struct isph *s, const struct isph_chunk *chunk) {
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    ISPH_ROW(s, i, laplacian, s, chunk, i, s->velocity, s->curvature[i]);
    for (int a = 0; a < 3; a++) s->curvature[i][a] *= s->calm[i];
  }
}

void isph_biharmonic_begin(struct isph *s) {
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) find_curvature(s, &s->chunks[c]);
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->curvature)});
}

TARGETS void isph_biharmonic(struct isph *s, const struct isph_chunk *chunk, size_t i,
                             double force[3]) {
  const double nu = BIHARMONIC_VISCOSITY * s->spacing * s->spacing * s->artificial_viscosity;
  double sum[3];
  ISPH_ROW(s, i, laplacian, s, chunk, i, s->curvature, sum);
  for (int a = 0; a < 3; a++) force[a] += s->biharmonic[i][a] = -nu * sum[a];
}
