#include "sphsolve/isph/moment.h"

#include "common/variants.h"
#include "sphsolve/isph/front.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/symmetric.h"
#include "sphsolve/isph/vector.h"
#include "sphsolve/isph/near_surface.h"
#include "sphsolve/isph/constants.h"

#include <math.h>

/* All operators of method isph (divergence, pressure matrix, gradient, viscosity) are made of one
 * number per pair, slope_ij = -W'(r)/r, and are exact for linear fields as far as the second moment
 *   M_i = sum_j V_j slope_ij r r
 * is the identity. On the lattice it is. In soil it is not: rows of water that enter keep their
 * spacing along the face and are stretched normal to it by 1/eps, and particles of different size
 * meet at the face; the normal component of M falls to .8, and the flux with it. So in soil the
 * slope of a pair becomes
 *   slope_ij [ 1 + r.(C_i + C_j).r / (2 r^2) ],   C = ((d + 2) E - tr(E) 1) / 2,   E = 1 - M,
 * with d the number of dimensions. For neighbours spread evenly over all directions sum V slope
 * (r.C.r/r^2) r r = (2 C + tr(C) 1)/(d + 2) = E, which removes the defect to first order. A pair
 * has one factor, at least 1/2, in all operators: the matrix stays symmetric and definite, and
 * divergence and gradient stay adjoint. C goes to 0 towards free water, where M is near 1.
 *
 * On a surface of normal n half of the moment along n is really missing, and
 *   E = (1 - 2 n.M.n) n n.
 * The foremost row of a front has .62 of that moment where a half-space has .5; without the
 * correction the pressure behind drives it and the next row by half as much again, and fronts are 4
 * to 6 % early. The ghost that closes the row of a particle on the surface (effects/surface.h) uses
 * the corrected slopes too. Next to the face of soil C is zero on the surface and beside it: with
 * it rows of ponds would stir there for ever. */

#define DEFECT_NORM_MAX 0.5 /* bound on the Frobenius norm of C, which keeps slopes positive */

/* Inverse of the symmetric m (xx xy xz yy yz zz) as the full 3x3 `inverse`; left unchanged if m is
 * nearly singular. */
void isph_moment_inverse(int dimensions, const double m[6], double inverse[9]) {
  double yy = dimensions == 2 ? 1 : m[3];
  double c00 = yy * m[5] - m[4] * m[4], c01 = m[2] * m[4] - m[1] * m[5],
         c02 = m[1] * m[4] - m[2] * yy;
  double determinant = m[0] * c00 + m[1] * c01 + m[2] * c02;
  if (!(determinant > MOMENT_LEAST)) return;
  double scale = 1 / determinant;
  inverse[0] = c00 * scale, inverse[1] = inverse[3] = c01 * scale;
  inverse[2] = inverse[6] = c02 * scale;
  inverse[4] = (m[0] * m[5] - m[2] * m[2]) * scale;
  inverse[5] = inverse[7] = (m[1] * m[2] - m[0] * m[4]) * scale;
  inverse[8] = (m[0] * yy - m[1] * m[1]) * scale;
}

/* Moves the missing moment e = 1 - M towards that on a surface of normal n, (1 - 2 n.M.n) n n, by
 * the weight `share`. */
static void one_sided_defect(const double n[3], double share, double e[6]) {
  const double square = dot(n, n);
  const double nn[6] = {n[0] * n[0], n[0] * n[1], n[0] * n[2],
                        n[1] * n[1], n[1] * n[2], n[2] * n[2]};
  if (!(square > 0)) return;
  const double across = 2 * symmetric_along(e, n) / square - 1; /* 1 - 2 n.M.n */
  for (int k = 0; k < 6; k++) e[k] += share * (across * nn[k] / square - e[k]);
}

void isph_moment_defect(struct isph *s, size_t i, const double moment[6], double one_sided) {
  float *defect = s->moment_defect[i];
  double e[6], size = 0, d = s->dimensions;
  for (int k = 0; k < 6; k++) e[k] = -moment[k];
  e[0] += 1, e[5] += 1, e[3] += s->dimensions == 3;
  if (s->on.surface) one_sided = fmax(one_sided, s->surface[i]);
  if (one_sided > 0) one_sided_defect(s->gradient_sum[i], one_sided, e);
  double trace = e[0] + e[3] + e[5];
  for (int k = 0; k < 6; k++) {
    bool diagonal = k == 0 || k == 3 || k == 5;
    e[k] = 0.5 * s->soil_fraction[i] * ((d + 2) * e[k] - (diagonal ? trace : 0));
    size += (diagonal ? 1 : 2) * e[k] * e[k];
  }
  double scale = fmin(1, DEFECT_NORM_MAX / fmax(sqrt(size), 1e-30));
  for (int k = 0; k < 6; k++) defect[k] = (float)(scale * e[k]);
}

/* r.C.r / r^2 */
static inline double along(const double c[6], const double r[3]) {
  const double square = dot(r, r);
  return square > 0 ? symmetric_along(c, r) / square : 0;
}

/* Corrects the slopes of eight pairs p of particle i, of which `counts` is 1, by a factor that is
 * that of r.(C_i + C_j).r; adds to the moment that they then have, and to the change of the
 * gradient sum. */
ROW void correct_eight(enum isph_images images, const struct isph *s, struct isph_chunk *chunk,
                       size_t i, size_t p, eight counts, eight moment[6], eight change[3]) {
  typedef float eight_floats __attribute__((vector_size(32), aligned(4), may_alias));
  eight_floats *slope = (eight_floats *)&chunk->slope[p], before = *slope;
  const float *own = s->moment_defect[i];
  uint32_t j[EIGHT_WIDE], code[EIGHT_WIDE];
  eight r[3], rr[6], turn[3], along = {0};
  for (size_t l = 0; l < EIGHT_WIDE; l++) j[l] = chunk->pair[p + l] & PAIR_MASK;
  for (size_t l = 0; l < EIGHT_WIDE; l++) code[l] = chunk->pair[p + l] >> PAIR_BITS;
  for (int a = 0; a < 3 && images == IMAGES_REFLECTED; a++)
    turn[a] = EIGHT_OF(s->image, code, .turn[a]);
  isph_separation_eight(images, s, i, &chunk->pair[p], j, r);
  rr[0] = r[0] * r[0], rr[1] = r[0] * r[1], rr[2] = r[0] * r[2];
  rr[3] = r[1] * r[1], rr[4] = r[1] * r[2], rr[5] = r[2] * r[2];
  for (int a = 0, k = 0; a < 3; a++)
    for (int b = a; b < 3; b++, k++) {
      eight other = EIGHT_OF(s->moment_defect, j, [k]);
      if (images == IMAGES_REFLECTED && a != b) other *= turn[a] * turn[b];
      along += (a == b ? 1 : 2) * ((double)own[k] + other) * rr[k];
    }
  const eight square = rr[0] + rr[3] + rr[5], least = square + 1e-300; /* no pair: 0 / 0 */
  const eight factor = 1 + counts * (0.5 * along / least);
  *slope = before * __builtin_convertvector(factor, eight_floats);
  const eight volume = counts * EIGHT_OF(s->volume, j, );
  const eight f = volume * __builtin_convertvector(*slope, eight);
  const eight more = volume * __builtin_convertvector(*slope - before, eight);
  for (int a = 0; a < 3; a++) change[a] += more * r[a];
  for (int k = 0; k < 6; k++) moment[k] += f * rr[k];
}

/* Corrects the slopes of particle i's pairs. Finds the moment that they then have, and the change
 * of the gradient sum. */
ROW void correct_slopes(enum isph_images images, const struct isph *s, struct isph_chunk *chunk,
                        size_t i, double moment[6], double change[3]) {
  static const double counts[2 * EIGHT_WIDE] = {1, 1, 1, 1, 1, 1, 1, 1};
  eight sums[6] = {{0}}, changed[3] = {{0}};
  const size_t first = s->pair_first[i], number = s->pair_number[i];
  for (size_t k = 0; k < number; k += EIGHT_WIDE) {
    const size_t beyond = number - k < EIGHT_WIDE ? EIGHT_WIDE - (number - k) : 0;
    const eight here = *(const eight *)&counts[beyond];
    correct_eight(images, s, chunk, i, first + k, here, sums, changed);
  }
  for (int a = 0; a < 3; a++) change[a] = EIGHT_SUM(changed[a]);
  for (int k = 0; k < 6; k++) moment[k] = EIGHT_SUM(sums[k]);
  double mean[6], r[3];
  for (int k = 0; k < 6; k++) mean[k] = (double)s->moment_defect[i][k];
  for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
    isph_separation_at(images, s, s->position[i], s->boundary_position, chunk->wall[p], r);
    chunk->wall_slope[p] *= (float)(1 + along(mean, r));
  }
}

/* Reduces the correction next to a surface, except deep in soil. */
static void fade_at_surface(struct isph *s) {
  for (size_t i = s->local.begin; i < s->local.end; i++)
    for (int k = 0; k < 6; k++)
      s->moment_defect[i][k] *= (float)(1 - s->near[i] * (1 - isph_front_deep(s, i)));
}

/* Limits the closure of the row of a particle on the surface deep in soil to the moment that is
 * missing. Along the normal the pairs give n.M.n and the void, with P = 0 half a size ahead, w size
 * |sum V grad W| (effects/surface.h); in a half-space both are 1/2. For a particle ahead of its
 * row, which has few neighbours, both together came to 1.1, and gravity drove it by as much more
 * than its row. */
static void limit_closure(struct isph *s, size_t i, const double moment[6]) {
  double *n = s->gradient_sum[i];
  const double square = dot(n, n);
  const double closes = s->surface[i] * s->size[i] * sqrt(square);
  if (!(closes > 0)) return;
  const double missing = fmin(0.5, fmax(0, 1 - symmetric_along(moment, n) / square));
  const double scale = 1 - isph_front_deep(s, i) * (1 - fmin(1, missing / closes));
  for (int a = 0; a < 3; a++) n[a] *= scale;
}

/* Whether there is soil at particle i or at a neighbour; if not, C is 0 at all of them. */
ROW bool is_near_soil(const struct isph *s, const struct isph_chunk *chunk, size_t i) {
  bool near = s->soil_fraction[i] > 0;
  if (near) return true;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++)
    near |= s->soil_fraction[chunk->pair[p] & PAIR_MASK] > 0;
  return near;
}

TARGETS static void correct_chunk(struct isph *s, struct isph_chunk *chunk) {
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    double moment[6], inverse[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, change[3];
    if (!is_near_soil(s, chunk, i)) continue;
    ISPH_ROW(s, i, correct_slopes, s, chunk, i, moment, change);
    if (s->on.surface && s->surface[i] > 0) {
      for (int a = 0; a < 3; a++) s->gradient_sum[i][a] += change[a];
      limit_closure(s, i, moment);
    }
    isph_moment_inverse(s->dimensions, moment, inverse);
    for (int k = 0; k < 9; k++) s->correction[i][k] = (float)inverse[k];
  }
}

void isph_moment_correct(struct isph *s) {
  if (s->on.surface) fade_at_surface(s);
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->moment_defect)});
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) correct_chunk(s, &s->chunks[c]);
  if (s->on.surface) isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->gradient_sum)});
}
