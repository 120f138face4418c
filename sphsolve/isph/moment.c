#include "sphsolve/isph/images.h"
#include "sphsolve/isph/ranks.h"

#include <math.h>

/* Every operator of method isph, divergence, pressure matrix, gradient, viscosity, is made of one
 * number a pair, slope_ij = -W'(r)/r, and is exact for linear fields as far as the second moment
 *   M_i = sum_j V_j slope_ij r r
 * is the unit matrix. On the lattice it is. In soil it is not: rows of water that enter keep their
 * spacing along the face and are drawn out across it, by 1/eps, and particles of different size
 * meet at the face; M across it falls to .8, and the flux with it. So in soil a slope counts
 *   slope_ij [ 1 + r.(C_i + C_j).r / (2 r^2) ],   C = ((d + 2) E - tr(E) 1) / 2,   E = 1 - M,
 * d the dimensions. For neighbours spread evenly over all directions sum V slope (r.C.r/r^2) r r =
 * (2 C + tr(C) 1)/(d + 2) = E, which takes the defect out to first order. A pair has one factor, at
 * least 1/2, in all operators: the matrix stays symmetric and definite, divergence and gradient
 * each other's adjoint as before. C fades towards free water, where M is near 1, and is none on the
 * surface and next to it, where neighbours are missing indeed. */

#define DEFECT_MOST 0.5 /* of C (Frobenius), so that slopes stay positive */

/* Inverse of the symmetric m (xx xy xz yy yz zz) into the full 3x3 `inverse`, left alone where m is
 * too flat to be trusted. */
void isph_moment_inverse(int dimensions, const double m[6], double inverse[9]) {
  const double least = 0.02;
  double yy = dimensions == 2 ? 1 : m[3];
  double c00 = yy * m[5] - m[4] * m[4], c01 = m[2] * m[4] - m[1] * m[5],
         c02 = m[1] * m[4] - m[2] * yy;
  double determinant = m[0] * c00 + m[1] * c01 + m[2] * c02;
  if (!(determinant > least)) return;
  double scale = 1 / determinant;
  inverse[0] = c00 * scale, inverse[1] = inverse[3] = c01 * scale;
  inverse[2] = inverse[6] = c02 * scale;
  inverse[4] = (m[0] * m[5] - m[2] * m[2]) * scale;
  inverse[5] = inverse[7] = (m[1] * m[2] - m[0] * m[4]) * scale;
  inverse[8] = (m[0] * yy - m[1] * m[1]) * scale;
}

void isph_moment_defect(struct isph *s, size_t i, const double moment[6],
                        const double wall_moment[6]) {
  float *defect = s->moment_defect[i];
  double e[6], size = 0, d = s->dimensions;
  for (int k = 0; k < 6; k++) e[k] = -moment[k] - wall_moment[k];
  e[0] += 1, e[5] += 1, e[3] += s->dimensions == 3;
  double trace = e[0] + e[3] + e[5];
  for (int k = 0; k < 6; k++) {
    bool diagonal = k == 0 || k == 3 || k == 5;
    e[k] = 0.5 * s->soil_fraction[i] * ((d + 2) * e[k] - (diagonal ? trace : 0));
    size += (diagonal ? 1 : 2) * e[k] * e[k];
  }
  double scale = fmin(1, DEFECT_MOST / fmax(sqrt(size), 1e-30));
  for (int k = 0; k < 6; k++) defect[k] = (float)(scale * e[k]);
}

/* r.C.r / r^2 */
static inline double along(const double c[6], const double r[3]) {
  double square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
  double sum = c[0] * r[0] * r[0] + c[3] * r[1] * r[1] + c[5] * r[2] * r[2] +
               2 * (c[1] * r[0] * r[1] + c[2] * r[0] * r[2] + c[4] * r[1] * r[2]);
  return square > 0 ? sum / square : 0;
}

/* Corrects the slopes of particle i's pairs, and finds the moment they then have. */
ROW void correct_slopes(enum isph_images images, const struct isph *s, struct isph_chunk *chunk,
                        size_t i, double moment[6]) {
  const double *xi = s->position[i];
  double own[6], mean[6], r[3];
  for (int k = 0; k < 6; k++) own[k] = (double)s->moment_defect[i][k];
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    uint32_t j = chunk->pair[p] & PAIR_MASK;
    for (int k = 0; k < 6; k++) mean[k] = 0.5 * (own[k] + (double)s->moment_defect[j][k]);
    isph_separation_at(images, s, xi, s->position, chunk->pair[p], r);
    chunk->slope[p] *= (float)(1 + along(mean, r));
    double f = s->volume[j] * (double)chunk->slope[p];
    moment[0] += f * r[0] * r[0], moment[1] += f * r[0] * r[1], moment[2] += f * r[0] * r[2];
    moment[3] += f * r[1] * r[1], moment[4] += f * r[1] * r[2], moment[5] += f * r[2] * r[2];
  }
  for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
    isph_separation_at(images, s, xi, s->boundary_position, chunk->wall[p], r);
    chunk->wall_slope[p] *= (float)(1 + along(own, r));
  }
}

/* No correction next to a surface. */
static void spare_surface(struct isph *s) {
  double *near = s->work[0];
  isph_find_near_surface(s, near);
  for (size_t i = s->local.begin; i < s->local.end; i++)
    for (int k = 0; k < 6; k++) s->moment_defect[i][k] *= (float)(1 - near[i]);
}

void isph_moment_correct(struct isph *s) {
  if (s->on.surface) spare_surface(s);
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->moment_defect)});
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) {
    struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++) {
      double moment[6] = {0}, inverse[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
      ISPH_ROW(s, i, correct_slopes, s, chunk, i, moment);
      isph_moment_inverse(s->dimensions, moment, inverse);
      for (int k = 0; k < 9; k++) s->correction[i][k] = (float)inverse[k];
    }
  }
}
